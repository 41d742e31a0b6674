"""Resources of the API: what is read, asked, drawn, told as events, and changed."""
