"""What a result says: statistics, lives, regimes, comparison, convergence."""
