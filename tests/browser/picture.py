"""Pixels of a PNG as Chromium writes it: 8 bits, RGB or RGBA, not interlaced."""

import struct
import zlib


class Picture:
    def __init__(self, png):
        self.width, self.height, depth, kind = struct.unpack(">IIBB", png[16:26])
        if depth != 8 or kind not in (2, 6):
            raise ValueError("not a picture of 8 bits in RGB or RGBA")
        self.size = 3 if kind == 2 else 4  # bytes a pixel
        data, at = b"", 8
        while at < len(png):
            length, name = struct.unpack(">I4s", png[at:at + 8])
            if name == b"IDAT":
                data += png[at + 8:at + 8 + length]
            at += 12 + length
        self.rows = self._unfilter(zlib.decompress(data))

    def _unfilter(self, data):
        stride, size = self.width * self.size, self.size
        rows, above = [], bytearray(stride)
        for k in range(self.height):
            at = k * (stride + 1)
            kind, row = data[at], bytearray(data[at + 1:at + 1 + stride])
            for i in range(stride if kind else 0):
                left = row[i - size] if i >= size else 0
                corner = above[i - size] if i >= size else 0
                if kind == 1:
                    guess = left
                elif kind == 2:
                    guess = above[i]
                elif kind == 3:
                    guess = (left + above[i]) // 2
                else:
                    guess = min((left, above[i], corner),
                                key=lambda value: abs(left + above[i] - corner - value))
                row[i] = (row[i] + guess) & 255
            rows.append(row)
            above = row
        return rows

    def pixel(self, x, y):
        return tuple(self.rows[y][x * self.size:x * self.size + 3])

    def columns_of(self, color, tolerance, top, bottom):
        """For every column the number of pixels of that colour between two rows."""
        counts = []
        for x in range(self.width):
            count = 0
            for y in range(top, bottom):
                pixel = self.pixel(x, y)
                if all(abs(a - b) <= tolerance for a, b in zip(pixel, color)):
                    count += 1
            counts.append(count)
        return counts
