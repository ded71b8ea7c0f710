"""What is done to a run afterwards: its status, more samples, failed rows again, verification."""
