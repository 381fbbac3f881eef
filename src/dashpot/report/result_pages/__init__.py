"""The page of each kind of result; the register of kinds says whose each is."""
