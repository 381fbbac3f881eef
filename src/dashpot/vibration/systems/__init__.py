"""Systems of rigid bodies on mounts: FRFs, state space, modes, response in time."""
