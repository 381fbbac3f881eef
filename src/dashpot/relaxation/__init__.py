"""The bench half: from a raw relaxation test to a fitted solid."""
