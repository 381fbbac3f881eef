"""The virtual rig and the virtual hammer."""
