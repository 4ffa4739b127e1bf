"""What scripts/accuracy compares, a module a part of mjdiag."""
