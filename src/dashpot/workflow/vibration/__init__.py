"""From files of measured vibration to FRFs, modes, and the solid behind them."""
