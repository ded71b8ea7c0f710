"""Which inputs matter: sensitivity indices by every method."""
