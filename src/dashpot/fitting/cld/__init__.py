"""From compression load deflection to the elastic law, and to the memory of several speeds."""
