"""After a run: its status, more samples, failed rows again, verification."""
