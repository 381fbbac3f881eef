"""A kind of test that a plug-in fits: columns in SI go in, numbers and checks come out."""
