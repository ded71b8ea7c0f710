"""After a run: its `status`, `verification`, and `amending`: more samples, failed rows again."""
