"""The way from a documented project to the text of its model: lowering, rewriting of document code,
emission."""
