"""Draws who is where: a box for each room, the robot, and each person as dark as it is probable there."""

ROOMS = ("office", "lab", "kitchen")
WIDTH, HEIGHT = 110, 96


def draw(state, belief, step):
    parts = []
    for number, room in enumerate(ROOMS):
        x = 5 + number * (WIDTH + 5)
        parts.append(
            f'<rect x="{x}" y="5" width="{WIDTH}" height="{HEIGHT}" rx="6" fill="#8882" stroke="#888"/>'
        )
        parts.append(f'<text x="{x + 8}" y="22" fill="#888">{room}</text>')
        if state["robot"] == room:
            parts.append(f'<circle cx="{x + 22}" cy="76" r="12" fill="#3b82f6"/>')
        for place, person in enumerate(("alice", "bob")):
            likely = belief[f"at[{person}]"].get(room, 0.0)
            y = 68 + 20 * place
            parts.append(f'<text x="{x + 50}" y="{y}" fill="#d97706" opacity="{likely:.3f}">{person}</text>')
    if state["is_given"]:
        parts.append('<text x="5" y="118" fill="#16a34a">the parcel is given</text>')
    size = 5 + len(ROOMS) * (WIDTH + 5)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} 124" font-family="sans-serif" '
        f'font-size="14">{"".join(parts)}</svg>'
    )
