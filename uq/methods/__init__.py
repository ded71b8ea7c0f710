"""Sensitivity methods: what each needs, what it gives, and its arithmetic."""
