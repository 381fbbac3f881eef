"""What plug-ins read, fit and write: plain data go in and come out, held to the contract."""
