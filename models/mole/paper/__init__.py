"""What reproduces the paper; nothing else needs it. Read `table`: its claims, and the model's."""
