"""Where recording and model part: force and momentum balances in weak form, tested against the sensors' noise."""
