#!/usr/bin/python3
"""Draws frames of a full run side by side, seen from the side with z up, as one PNG.

    twinchute full data/scenes/c9-inflation.toml --fields 50 --out c9
    docs/pictures/render_fields.py c9/fields.pvd c9.png --times 0 0.4 0.8 1.2 2

Needs VTK's Python modules (Debian: python3-vtk9) and neither a display nor a graphics card: it paints the
cells from back to front itself. Each panel shows the frame nearest to a time that was asked for, its lowest
point at the foot of the picture, all at one scale.
"""
import argparse
import math
import os
import sys
import xml.etree.ElementTree as xml

import vtkmodules.vtkRenderingFreeType  # noqa: F401, draws text
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkImagingCore import vtkImageShrink3D
from vtkmodules.vtkImagingSources import vtkImageCanvasSource2D
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkTextProperty, vtkTextRenderer

SAMPLES = 3  # along each edge of a pixel
PAPER, INK, LINE = (255, 255, 255), (40, 44, 52), (120, 126, 138)
KINDS = {"fabric": 0, "line": 4, "riser": 5, "payload": 6}
# From dark to bright, of even steps in lightness (viridis at nine places).
SCALE = [(68, 1, 84), (71, 44, 122), (59, 81, 139), (44, 113, 142), (33, 144, 141),
         (39, 173, 129), (92, 200, 99), (170, 220, 50), (253, 231, 37)]
STATES = {0: ((176, 182, 192), "slack"), 1: ((242, 166, 90), "wrinkled"), 2: ((64, 120, 192), "taut")}
FIELDS = {
    "stress": ("stress_first_N_m", "first principal stress [N/m]"),
    "strain": ("strain_first", "first principal strain [-]"),
    "wrinkling": ("wrinkling_state", "wrinkling"),
}


def frames_of(collection):
    """(time, file) of every frame, in the order of the times."""
    directory = os.path.dirname(os.path.abspath(collection))
    sets = xml.parse(collection).getroot().iter("DataSet")
    return sorted((float(s.get("timestep")), os.path.join(directory, s.get("file"))) for s in sets)


class Frame:
    """One grid as plain lists, turned so that the picture's x and y come first and depth last."""

    def __init__(self, time, file, field, azimuth):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(file)
        reader.Update()
        grid = reader.GetOutput()
        if grid.GetNumberOfCells() == 0:
            sys.exit(f"{file}: no cells, is this a file of twinchute?")
        self.time = time
        # The eye looks horizontally along this heading; what is to its right is to the picture's right.
        look = (math.sin(azimuth), math.cos(azimuth))
        self.points = []
        for i in range(grid.GetNumberOfPoints()):
            x, y, z = grid.GetPoint(i)
            self.points.append((x * look[1] - y * look[0], z, x * look[0] + y * look[1]))
        kind = grid.GetCellData().GetArray("kind")
        values = grid.GetCellData().GetArray(field)
        self.triangles, self.lines, self.payload = [], [], None
        for cell in range(grid.GetNumberOfCells()):
            ids = grid.GetCell(cell).GetPointIds()
            nodes = [self.points[ids.GetId(k)] for k in range(ids.GetNumberOfIds())]
            k = int(kind.GetValue(cell))
            if k == KINDS["fabric"]:
                self.triangles.append((nodes, values.GetValue(cell)))
            elif k == KINDS["payload"]:
                self.payload = nodes[0]
            elif k in (KINDS["line"], KINDS["riser"]):
                self.lines.append((nodes, k))

    def box(self):
        xs, ys = [p[0] for p in self.points], [p[1] for p in self.points]
        return min(xs), max(xs), min(ys), max(ys)


def shaded(colour, nodes):
    """A lamp at the eye: fabric that is seen edge-on is darker."""
    a, b, c = nodes
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(n * n for n in normal))
    light = 0.55 + 0.45 * (abs(normal[2]) / length if length > 0 else 0)
    return tuple(light * c for c in colour)


def colour_at(share):
    place = min(max(share, 0.0), 1.0) * (len(SCALE) - 1)
    low = min(int(place), len(SCALE) - 2)
    return tuple(a + (b - a) * (place - low) for a, b in zip(SCALE[low], SCALE[low + 1]))


class Canvas:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.source = vtkImageCanvasSource2D()
        self.source.SetScalarTypeToUnsignedChar()
        self.source.SetNumberOfScalarComponents(3)
        self.source.SetExtent(0, width * SAMPLES - 1, 0, height * SAMPLES - 1, 0, 0)
        self.colour(PAPER)
        self.source.FillBox(0, width * SAMPLES - 1, 0, height * SAMPLES - 1)

    def colour(self, rgb):
        self.source.SetDrawColor(*rgb)

    def at(self, x, y):
        """Clipped by hand: the source writes wherever it is told to."""
        return (min(max(int(round(x * SAMPLES)), 0), self.width * SAMPLES - 1),
                min(max(int(round(y * SAMPLES)), 0), self.height * SAMPLES - 1))

    def triangle(self, rgb, corners):
        """Row by row: FillTriangle of VTK 9.1 paints beyond the corners of thin triangles."""
        self.colour(rgb)
        p = sorted(self.at(*corner)[::-1] for corner in corners)
        for y in range(p[0][0], p[2][0] + 1):
            xs = []
            for (y0, x0), (y1, x1) in ((p[0], p[1]), (p[1], p[2]), (p[0], p[2])):
                if y0 == y1 == y:
                    xs += [x0, x1]
                elif y0 <= y <= y1 and y0 < y1:
                    xs.append(x0 + (x1 - x0) * (y - y0) / (y1 - y0))
            self.source.DrawSegment(round(min(xs)), y, round(max(xs)), y)

    def line(self, rgb, a, b, width=1):
        """`width` samples wide; row by row too: DrawSegment leaves gaps where segments meet."""
        self.colour(rgb)
        (y0, x0), (y1, x1) = sorted((self.at(*a)[::-1], self.at(*b)[::-1]))
        for y in range(y0, y1 + 1):
            ends = [x0, x1] if y0 == y1 else [
                x0 + (x1 - x0) * min(max((y + half - y0) / (y1 - y0), 0), 1) for half in (-0.5, 0.5)]
            self.source.DrawSegment(round(min(ends)), y,
                                    min(round(max(ends)) + width - 1, self.width * SAMPLES - 1), y)

    def box(self, rgb, x, y, width, height):
        self.colour(rgb)
        (x0, y0), (x1, y1) = self.at(x, y), self.at(x + width, y + height)
        self.source.FillBox(x0, x1, y0, y1)

    def disc(self, rgb, x, y, radius):
        self.colour(rgb)
        for k in range(-int(radius * SAMPLES), int(radius * SAMPLES) + 1):
            half = math.sqrt(max(0.0, (radius * SAMPLES) ** 2 - k * k)) / SAMPLES
            self.source.DrawSegment(*self.at(x - half, y + k / SAMPLES), *self.at(x + half, y + k / SAMPLES))

    def image(self):
        """Every pixel is the mean of its samples."""
        shrink = vtkImageShrink3D()
        shrink.SetInputConnection(self.source.GetOutputPort())
        shrink.SetShrinkFactors(SAMPLES, SAMPLES, 1)
        shrink.AveragingOn()
        shrink.Update()
        copy = vtkImageData()
        copy.DeepCopy(shrink.GetOutput())
        return copy


def write_text(image, text, x, y, size=15, centred=True):
    style = vtkTextProperty()
    style.SetFontSize(size)
    style.SetColor(1, 1, 1)
    stencil = vtkImageData()
    size_of_text = [0, 0]
    if not vtkTextRenderer.GetInstance().RenderString(style, text, stencil, size_of_text, 72):
        sys.exit("VTK has no font to write with")
    x0, x1, y0, y1 = stencil.GetExtent()[:4]
    left = int(x - size_of_text[0] / 2) if centred else int(x)
    limit = image.GetDimensions()
    for j in range(y0, y1 + 1):
        for i in range(x0, x1 + 1):
            alpha = stencil.GetScalarComponentAsDouble(i, j, 0, 3) / 255
            px, py = left + i - x0, int(y) + j - y0
            if alpha <= 0 or not (0 <= px < limit[0] and 0 <= py < limit[1]):
                continue
            for k in range(3):
                old = image.GetScalarComponentAsDouble(px, py, 0, k)
                image.SetScalarComponentFromDouble(px, py, 0, k, old + alpha * (INK[k] - old))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("collection", help="fields.pvd of a full run")
    parser.add_argument("picture", help="the PNG to write")
    parser.add_argument("--times", type=float, nargs="+", help="[s] of the frames; default: six over the run")
    parser.add_argument("--by", choices=sorted(FIELDS), default="stress", help="what colours the fabric")
    parser.add_argument("--top", type=float, help="value of the brightest colour; default: the 98th percentile")
    parser.add_argument("--azimuth", type=float, default=0.0,
                        help="heading in which the eye looks, degrees clockwise from north (default: 0)")
    parser.add_argument("--height", type=int, default=560, help="of the picture, in pixels")
    options = parser.parse_args()

    every = frames_of(options.collection)
    if not every:
        sys.exit(f"{options.collection}: no frames")
    last = every[-1][0]
    times = options.times or [last * k / 5 for k in range(6)]
    field, title = FIELDS[options.by]
    chosen = [min(every, key=lambda frame: abs(frame[0] - time)) for time in times]
    frames = [Frame(time, file, field, math.radians(options.azimuth)) for time, file in chosen]

    legend, gap, foot = 56, 16, 34
    boxes = [frame.box() for frame in frames]
    tallest = max(box[3] - box[2] for box in boxes)
    scale = (options.height - legend - foot - 2 * gap) / tallest  # pixels a metre
    widths = [max(90, int(scale * (box[1] - box[0])) + 2 * gap) for box in boxes]
    canvas = Canvas(max(sum(widths), 420), options.height)

    values = sorted(v for frame in frames for _, v in frame.triangles)
    top = options.top or values[int(0.98 * (len(values) - 1))] or 1.0
    left, labels = (canvas.width - sum(widths)) // 2, []
    for frame, box, width in zip(frames, boxes, widths):
        middle = 0.5 * (box[0] + box[1])

        def place(p):
            return left + width / 2 + scale * (p[0] - middle), foot + gap + scale * (p[1] - box[2])

        # Depth grows away from the eye: the farthest first.
        parts = [(max(n[2] for n in nodes), 0, nodes, value) for nodes, value in frame.triangles]
        parts += [(max(n[2] for n in nodes), 1, nodes, kind) for nodes, kind in frame.lines]
        for _, is_line, nodes, value in sorted(parts, key=lambda part: (-part[0], part[1])):
            if is_line:
                canvas.line(INK if value == KINDS["riser"] else LINE, place(nodes[0]), place(nodes[1]),
                            3 if value == KINDS["riser"] else 2)
                continue
            rgb = STATES[int(value)][0] if options.by == "wrinkling" else colour_at(value / top)
            canvas.triangle(shaded(rgb, nodes), [place(n) for n in nodes])
        if frame.payload:
            canvas.disc(INK, *place(frame.payload), 4)
        labels.append((left + width / 2, f"{frame.time:.2f} s"))
        left += width

    bar, base = 240, options.height - 28
    start = (canvas.width - bar) / 2
    if options.by == "wrinkling":
        for i, (rgb, word) in enumerate(STATES.values()):
            x = start + i * bar / 3
            canvas.box(rgb, x, base, 12, 12)
            labels.append((x + 18, word))
    else:
        for i in range(bar):
            canvas.box(colour_at(i / bar), start + i, base, 1, 10)
    image = canvas.image()
    for i, (x, text) in enumerate(labels):
        if i < len(frames):
            write_text(image, text, x, 10)
        else:
            write_text(image, text, x, base, 13, False)
    if options.by != "wrinkling":
        write_text(image, "0", start - 10, base - 1, 13)
        write_text(image, f"{top:.3g}", start + bar + 8, base - 1, 13, False)
        write_text(image, title, canvas.width / 2, base - 20, 13)

    writer = vtkPNGWriter()
    writer.SetFileName(options.picture)
    writer.SetInputData(image)
    writer.Write()
    if writer.GetErrorCode() != 0:
        sys.exit(f"cannot write {options.picture}")


if __name__ == "__main__":
    main()
