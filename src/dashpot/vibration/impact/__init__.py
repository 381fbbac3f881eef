"""FRF estimation from hammer hits."""
