"""Operation: what the operators do with the laboratory, and what it does to them (Appendix E)."""
