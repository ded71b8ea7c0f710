"""What is uncertain: laws, dependence between inputs, observed data."""
