// Draws the plots of a page. Every figure.plot holds its data as JSON.
(function () {
  const { hasShapes, color, drawUnderlay, drawShapes } = drawing;

  function decode(base64) {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }

  const logarithmicX = (plot) => plot.kind === 'spectrum' || plot.kind === 'bode';

  function decodeAll(plot) {
    for (const series of (plot.points || []).concat(plot.curves || [])) {
      for (const name of ['samples', 'x', 'y']) {
        if (series[name] !== undefined) series[name] = decode(series[name]);
      }
    }
    if (plot.frequency) plot.frequency = decode(plot.frequency);
    if (plot.bars) {
      plot.bars.edges = decode(plot.bars.edges);
      plot.bars.counts = decode(plot.bars.counts);
    }
    return plot;
  }

  function sampledRows(plot) {
    const spectrum = plot.kind === 'spectrum';
    const table = [];
    if (plot.curves.length === 0) return table;
    for (let k = 0; k < plot.curves[0].samples.length; ++k) {
      const x = plot.frequency[k];
      if (logarithmicX(plot) && !(x > 0)) continue;
      const row = [x];
      for (const curve of plot.curves) {
        const y = curve.samples[k];
        row.push(!Number.isFinite(y) || (spectrum && !(y > 0)) ? null : y);
      }
      table.push(row);
    }
    return table;
  }

  // All that the axes have to hold, in the order of x.
  function shapeRows(plot) {
    const table = [];
    for (const series of (plot.points || []).concat(plot.curves)) {
      series.x.forEach((x, k) => table.push([x, series.y[k]]));
    }
    if (plot.bars) {
      plot.bars.counts.forEach((count, k) => {
        table.push([plot.bars.edges[k], count], [plot.bars.edges[k + 1], count]);
      });
    }
    for (const mark of plot.marks || []) table.push([mark.value, 0]);
    return table.filter((row) => row.every(Number.isFinite)).sort((a, b) => a[0] - b[0]);
  }

  function number(value) {
    return value === 0 ? '0' : String(parseFloat(value.toPrecision(6)));
  }

  function power(exponent) {
    if (exponent >= -2 && exponent <= 4) return number(Math.pow(10, exponent));
    const digits = '⁰¹²³⁴⁵⁶⁷⁸⁹';
    return '10' + String(exponent).replace('-', '⁻').replace(/\d/g, (d) => digits[d]);
  }

  // Decades, labelled as often as there is room; 2 and 5 as well on a short axis.
  function logarithmicTicks(low, high, pixels, options) {
    const first = Math.floor(Math.log10(low));
    const last = Math.ceil(Math.log10(high));
    const room = pixels / options('pixelsPerLabel');
    const stride = Math.max(1, Math.ceil((last - first) / room));
    const labelled = last - first <= 2 ? [1, 2, 5] : [1];
    const ticks = [];
    for (let exponent = first; exponent <= last; ++exponent) {
      for (let digit = 1; digit <= 9; ++digit) {
        const v = digit * Math.pow(10, exponent);
        if (v < low || v > high || (stride > 1 && digit > 1)) continue;
        const shown = labelled.includes(digit) && exponent % stride === 0;
        const label = digit === 1 ? power(exponent) : number(v);
        ticks.push({ v: v, label: shown ? label : '' });
      }
    }
    return ticks;
  }

  function entry(kind, tint, label, value) {
    const span = document.createElement('span');
    const line = document.createElement('i');
    line.className = kind;
    if (tint) line.style.color = tint;
    span.append(line, label);
    if (value !== undefined) {
      const bold = document.createElement('b');
      bold.textContent = ' ' + value;
      span.append(bold);
    }
    return span;
  }

  function addShapes(box, plot, scheme) {
    if (plot.bars) box.append(entry('bars', color('bars', scheme), plot.bars.label));
    for (const points of plot.points || []) {
      box.append(entry('points', color(points.role, scheme), points.label));
    }
    for (const curve of plot.curves) {
      box.append(entry('curve', color(curve.role, scheme), curve.label));
    }
  }

  // Levels and marks with a label, each label once.
  function addDashes(box, lines, tint) {
    const labels = new Set(lines.map((line) => line.label));
    labels.forEach((label) => {
      if (label) box.append(entry('level', tint, label));
    });
  }

  function legend(plot, scheme) {
    const unit = plot.unit ? ' ' + plot.unit : '';
    return function (data) {
      const box = document.createElement('div');
      if (hasShapes(plot)) {
        addShapes(box, plot, scheme());
      } else {
        for (const series of data.series) {
          const shown = data.x !== undefined && Number.isFinite(series.y);
          const value = shown ? number(series.y) + unit : undefined;
          box.append(entry('curve', series.color, series.label, value));
        }
      }
      addDashes(box, plot.levels || [], color('noise', scheme()));
      const named = plot.kind === 'spectrum' && (plot.marks || []).length > 0;
      addDashes(box, named ? [{ label: 'tones' }] : plot.marks || [],
          color('quiet', scheme()));
      for (const band of plot.bands || []) {
        if (band.label) box.append(entry('band', '', band.label));
      }
      if (data.x !== undefined && !hasShapes(plot)) {
        const at = document.createElement('span');
        at.textContent = 'at ' + number(data.x) + (logarithmicX(plot) ? ' Hz' : ' s');
        box.append(at);
      }
      return box.innerHTML;
    };
  }

  // One finger scrolls the page; two fingers zoom the plot.
  function touchFriendly() {
    const model = Object.assign({}, Dygraph.defaultInteractionModel);
    const twoFingers = (handler) => function (event, graph, context) {
      if (event.touches.length > 1) handler(event, graph, context);
    };
    model.touchstart = twoFingers(model.touchstart);
    model.touchmove = twoFingers(model.touchmove);
    return model;
  }

  function colors(plot, scheme) {
    return {
      colors: hasShapes(plot) ? [color('ink', scheme)] :
          plot.curves.map((curve) => color(curve.role, scheme)),
      axisLineColor: color('quiet', scheme),
      gridLineColor: color('rule', scheme),
    };
  }

  // dygraphs takes the names of axes for HTML.
  function escaped(text) {
    const box = document.createElement('div');
    box.textContent = text;
    return box.innerHTML;
  }

  // What sampled curves and shapes each ask of dygraphs.
  function sampledOptions(plot) {
    const series = {};
    for (const curve of plot.curves) {
      // The simulated curve lies thin on the measured one, so that both stay visible.
      const wide = curve.role === 'measured' ? 2.5 : 1.2;
      series[curve.label] = { strokeWidth: plot.kind === 'bode' ? 2 : wide };
    }
    return {
      labels: ['x'].concat(plot.curves.map((curve) => curve.label)),
      series: series,
      // Room above the data for the names of marks: two rows of them.
      yRangePad: plot.kind === 'spectrum' && (plot.marks || []).length > 0 ? 36 : 8,
      highlightCircleSize: 3,
    };
  }

  function shapeOptions(plot, scheme) {
    const pads = plot.kind === 'xy' ? { yRangePad: 8 } : { includeZero: true };
    return Object.assign({
      labels: ['x', 'y'],
      plotter: drawShapes(plot, scheme),
      xRangePad: 8,
      highlightCircleSize: 0,
    }, pads);
  }

  function draw(figure, scheme) {
    const plot = decodeAll(JSON.parse(figure.querySelector('script').textContent));
    const shapes = hasShapes(plot);
    const axis = (logarithmic) => ({
      axisLabelFormatter: number,
      ticker: logarithmic ? logarithmicTicks : Dygraph.numericLinearTicks,
    });
    const logX = logarithmicX(plot);
    const logY = plot.kind === 'spectrum';
    const frame = figure.querySelector('.chart');
    const rows = plot.kind === 'time' ? sampling.rows(plot, null, frame.clientWidth) :
        shapes ? shapeRows(plot) : sampledRows(plot);
    if (rows.length === 0) return null;
    const graph = new Dygraph(frame, rows, Object.assign({
      labelsDiv: figure.querySelector('.legend'),
      legend: 'always',
      legendFormatter: legend(plot, scheme),
      xlabel: escaped(plot.x_label),
      ylabel: escaped(plot.y_label),
      logscale: logY,
      axes: {
        x: Object.assign({ logscale: logX, pixelsPerLabel: 70 }, axis(logX)),
        y: Object.assign({ axisLabelWidth: 58, pixelsPerLabel: 26 }, axis(logY)),
      },
      axisLabelFontSize: 12,
      xLabelHeight: 20,
      yLabelWidth: 20,
      rightGap: 12,
      interactionModel: touchFriendly(),
      underlayCallback: drawUnderlay(plot, scheme),
    }, shapes ? shapeOptions(plot, scheme) : sampledOptions(plot), colors(plot, scheme())));
    frame.dygraph = graph;  // for the console and for tests
    return { plot: plot, graph: graph, frame: frame, rows: rows };
  }

  const screen = document.documentElement;
  const paper = document.getElementById('paper');
  let scheme = screen;
  const charts = Array.from(document.querySelectorAll('figure.plot'),
      (figure) => draw(figure, () => scheme)).filter((chart) => chart !== null);

  function recolor() {
    for (const chart of charts) chart.graph.updateOptions(colors(chart.plot, scheme));
  }

  // All time plots show the same window, [from, to] or null for all of their record,
  // in rows made for it.
  const timeCharts = charts.filter((chart) => chart.plot.kind === 'time');
  let redrawing = false;
  let shown = null;
  function show(window) {
    redrawing = true;
    shown = window;
    for (const chart of timeCharts) {
      chart.rows = sampling.rows(chart.plot, window, chart.frame.clientWidth);
      chart.graph.updateOptions({ file: chart.rows, dateWindow: window });
    }
    redrawing = false;
  }

  // After the reader has zoomed or moved one of them.
  function follow(graph, initial) {
    if (initial || redrawing) return;
    const window = graph.isZoomed('x') ? graph.xAxisRange() : null;
    if (String(window) !== String(shown)) show(window);
  }

  function point(source, time) {
    for (const chart of timeCharts) {
      if (chart === source) continue;
      const row = sampling.nearest(chart.rows, time);
      if (row < 0) chart.graph.clearSelection();
      else chart.graph.setSelection(row);
    }
  }

  for (const chart of timeCharts) {
    chart.graph.updateOptions({
      drawCallback: follow,
      highlightCallback: (event, time) => point(chart, time),
      unhighlightCallback: () => point(chart, NaN),
    }, true);
  }

  document.getElementById('reset-zoom').addEventListener('click', () => {
    for (const chart of charts) chart.graph.resetZoom();
  });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolor);
  // Charts are as wide as the screen until they are told; A4 and Letter hold this.
  const paperWidth = 680;
  function fit(width) {
    for (const chart of charts) {
      if (width) {
        chart.graph.resize(width, chart.frame.clientHeight);
      } else {
        chart.frame.style.width = '';
        chart.graph.resize();
      }
    }
  }
  window.addEventListener('beforeprint', () => {
    scheme = paper;
    recolor();
    fit(paperWidth);
  });
  window.addEventListener('afterprint', () => {
    scheme = screen;
    fit(0);
    recolor();
  });
})();
