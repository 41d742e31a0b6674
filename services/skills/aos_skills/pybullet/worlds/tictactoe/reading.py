"""Reading the board from a picture: find its rim, look at it from straight above, tell the marks apart."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]

SIDE_PX = 450
"""The side of the board within its rim, seen from straight above."""
BOARD_M, GRID_M = 0.29, 0.24  # Within the rim, and of the nine cells.
CELL_PX = round(SIDE_PX * GRID_M / BOARD_M / 3)
MARGIN_PX = round(SIDE_PX * (1 - GRID_M / BOARD_M) / 2)
LINE_PX = 14
"""A strip this wide is cut off on each side of a cell, for its lines."""
MIN_AREA = 0.03
"""The least area of a board, as a share of the picture."""
MIN_INK = 0.02
"""Share of a cell's pixels; less is noise."""
MIN_INSIDE = 0.15
"""Share of a cross's ink that lies in its inner half, at least; of a circle's there is none."""


def board_in(picture: npt.NDArray[Any]) -> str | None:
    """Nine characters, row by row from the top left: `O`, `X`, or `?` for nothing. None if there is none."""
    grey: Picture = np.asarray(
        cv2.GaussianBlur(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY), (3, 3), 0), np.uint8
    )
    corners = _corners(grey)
    if corners is None:
        return None
    square = np.array([[0, 0], [SIDE_PX, 0], [SIDE_PX, SIDE_PX], [0, SIDE_PX]], dtype=np.float32)
    turned = cv2.getPerspectiveTransform(corners, square)
    flat: Picture = np.asarray(cv2.warpPerspective(grey, turned, (SIDE_PX, SIDE_PX)), np.uint8)
    # Ink is dark against what is around it, whatever the light.
    ink: Picture = np.asarray(
        cv2.adaptiveThreshold(flat, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, 75, 25), np.uint8
    )
    return "".join(_mark(ink, *divmod(cell, 3)) for cell in range(9))


def _corners(grey: Picture) -> npt.NDArray[np.float32] | None:
    """Finds the white board's outer edge: top left, top right, bottom right, bottom left."""
    _, bright = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    contours, _ = cv2.findContours(bright, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    for contour in sorted(contours, key=cv2.contourArea, reverse=True):
        if cv2.contourArea(contour) < MIN_AREA * grey.size:
            return None
        x, y, width, height = cv2.boundingRect(contour)
        if x == 0 or y == 0 or x + width == grey.shape[1] or y + height == grey.shape[0]:
            continue  # Not whole, or no board at all.
        hull = cv2.convexHull(contour)
        corners = cv2.approxPolyDP(hull, 0.03 * cv2.arcLength(hull, True), True)
        if len(corners) == 4:
            points = corners[:, 0, :].astype(np.float32)
            points = points[np.argsort(points[:, 1])]
            top, bottom = points[:2], points[2:]
            top, bottom = top[np.argsort(top[:, 0])], bottom[np.argsort(-bottom[:, 0])]
            return np.concatenate([top, bottom])
    return None


def _mark(ink: Picture, row: int, column: int) -> str:
    """A cross has ink in its middle, a circle only far from it, whether or not its line is closed."""
    top, left = MARGIN_PX + row * CELL_PX + LINE_PX, MARGIN_PX + column * CELL_PX + LINE_PX
    side = CELL_PX - 2 * LINE_PX
    cell = ink[top : top + side, left : left + side]
    points = np.argwhere(cell)
    if len(points) < MIN_INK * cell.size:
        return "?"
    middle = (np.quantile(points, 0.02, axis=0) + np.quantile(points, 0.98, axis=0)) / 2
    distances = np.hypot(*(points - middle).T)
    inside = np.mean(distances < np.quantile(distances, 0.9) / 2)
    return "X" if inside > MIN_INSIDE else "O"
