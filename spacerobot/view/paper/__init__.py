"""The paper's table and figures, drawn again from theory and simulation: data, figures, page."""
