"""What reproduces the paper, and nothing else needs: its claims beside ours, in `table`."""
