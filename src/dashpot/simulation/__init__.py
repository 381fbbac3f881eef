"""The virtual rig and the virtual hammer: records whose truth is known."""
