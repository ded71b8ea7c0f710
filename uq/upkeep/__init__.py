"""What is done to a run afterwards: its status, more rows, failed rows again, verification."""
