// What a plot has beside the curves of dygraphs: bands, levels, names of moments, and
// points, bars and free lines.
const drawing = (function () {
  // Dygraphs gives these plots their axes, and drawShapes the rest.
  const hasShapes = (plot) => plot.kind === 'xy' || plot.kind === 'histogram';

  function color(name, scheme) {
    return getComputedStyle(scheme).getPropertyValue('--' + name).trim();
  }

  function drawBands(canvas, area, graph, plot, scheme) {
    canvas.fillStyle = color('band', scheme);
    for (const band of plot.bands || []) {
      const left = graph.toDomXCoord(band.from);
      const width = Math.max(2, graph.toDomXCoord(band.to) - left);
      canvas.fillRect(left, area.y, width, area.h);
    }
  }

  // Levels across and marks down the plot.
  function drawDashes(canvas, area, graph, plot, scheme) {
    const line = (x0, y0, x1, y1) => {
      canvas.beginPath();
      canvas.moveTo(x0, y0);
      canvas.lineTo(x1, y1);
      canvas.stroke();
    };
    canvas.strokeStyle = color('noise', scheme);
    canvas.lineWidth = 1.5;
    canvas.setLineDash([6, 4]);
    for (const level of plot.levels || []) {
      const y = graph.toDomYCoord(level.value);
      line(area.x, y, area.x + area.w, y);
    }
    canvas.strokeStyle = color('quiet', scheme);
    for (const mark of plot.marks || []) {
      // toDomXCoord takes every axis for a linear one.
      const x = area.x + graph.toPercentXCoord(mark.value) * area.w;
      line(x, area.y, x, area.y + area.h);
    }
  }

  // The names of the marks of a spectrum beside their lines, lower where one would lie
  // on another.
  function drawNames(canvas, area, graph, plot, scheme) {
    canvas.font = '12px system-ui, "DejaVu Sans", sans-serif';
    const ends = [];
    for (const mark of (plot.marks || []).slice().sort((a, b) => a.value - b.value)) {
      const x = area.x + graph.toPercentXCoord(mark.value) * area.w;
      if (!(x >= area.x && x <= area.x + area.w)) continue;
      const width = canvas.measureText(mark.label).width;
      const left = Math.min(x + 4, area.x + area.w - width);
      let row = ends.findIndex((end) => end < left);
      if (row < 0) row = ends.length;
      ends[row] = left + width + 6;
      // The line of a neighbour does not strike the name through.
      canvas.fillStyle = color('paper', scheme);
      canvas.fillRect(left - 1, area.y + 1 + 14 * row, width + 2, 14);
      canvas.fillStyle = color('ink', scheme);
      canvas.fillText(mark.label, left, area.y + 12 + 14 * row);
    }
  }

  function drawUnderlay(plot, scheme) {
    return function (canvas, area, graph) {
      canvas.save();
      canvas.beginPath();
      canvas.rect(area.x, area.y, area.w, area.h);
      canvas.clip();
      drawBands(canvas, area, graph, plot, scheme());
      // Bars would hide them.
      if (!hasShapes(plot)) drawDashes(canvas, area, graph, plot, scheme());
      if (plot.kind === 'spectrum') drawNames(canvas, area, graph, plot, scheme());
      canvas.restore();
    };
  }

  function drawBars(canvas, graph, bars, tint) {
    const floor = graph.toDomYCoord(0);
    canvas.fillStyle = tint;
    bars.counts.forEach((count, k) => {
      const left = graph.toDomXCoord(bars.edges[k]);
      const right = graph.toDomXCoord(bars.edges[k + 1]);
      const top = graph.toDomYCoord(count);
      // A gap where there is room for one; bars of few counts stay visible.
      const width = right - left > 4 ? right - left - 1 : right - left;
      if (count > 0) canvas.fillRect(left, Math.min(top, floor - 1), width,
          Math.max(1, floor - top));
    });
  }

  function drawPoints(canvas, graph, points, tint) {
    // Many points overlap: where they are dense they look dense.
    const many = points.x.length > 500;
    const size = many ? 2 : 5;
    canvas.fillStyle = tint;
    canvas.globalAlpha = many ? 0.5 : 0.85;
    points.x.forEach((x, k) => {
      canvas.fillRect(graph.toDomXCoord(x) - size / 2,
          graph.toDomYCoord(points.y[k]) - size / 2, size, size);
    });
    canvas.globalAlpha = 1;
  }

  function drawLine(canvas, graph, curve, tint) {
    canvas.strokeStyle = tint;
    canvas.lineWidth = 2;
    canvas.beginPath();
    let open = false;
    curve.x.forEach((x, k) => {
      const finite = Number.isFinite(x) && Number.isFinite(curve.y[k]);
      if (finite) {
        const place = [graph.toDomXCoord(x), graph.toDomYCoord(curve.y[k])];
        if (open) canvas.lineTo(...place);
        else canvas.moveTo(...place);
      }
      open = finite;
    });
    canvas.stroke();
  }

  function drawShapes(plot, scheme) {
    return function (event) {
      const canvas = event.drawingContext;
      const tint = (series) => color(series.role, scheme());
      canvas.save();
      if (plot.bars) drawBars(canvas, event.dygraph, plot.bars, color('bars', scheme()));
      for (const points of plot.points || []) {
        drawPoints(canvas, event.dygraph, points, tint(points));
      }
      for (const curve of plot.curves) {
        drawLine(canvas, event.dygraph, curve, tint(curve));
      }
      drawDashes(canvas, event.plotArea, event.dygraph, plot, scheme());
      canvas.restore();
    };
  }

  return { hasShapes, color, drawUnderlay, drawShapes };
})();
