"""What a test can and cannot tell, before it is run."""
