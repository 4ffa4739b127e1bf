'use strict';
// Draws the plots of a page. Every figure.plot holds its data as JSON.
(function () {
  function decode(base64) {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  }

  function rows(plot) {
    const curves = plot.curves.map((curve) => decode(curve.samples));
    const spectrum = plot.kind === 'spectrum';
    const frequency = spectrum ? decode(plot.frequency) : null;
    const table = [];
    for (let k = 0; k < curves[0].length; ++k) {
      const x = spectrum ? frequency[k] : plot.start + k * plot.step;
      if (spectrum && !(x > 0)) continue;
      const row = [x];
      for (const curve of curves) {
        const y = curve[k];
        row.push(!Number.isFinite(y) || (spectrum && !(y > 0)) ? null : y);
      }
      table.push(row);
    }
    return table;
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

  function color(name, scheme) {
    return getComputedStyle(scheme).getPropertyValue('--' + name).trim();
  }

  function drawMarks(plot, scheme) {
    return function (canvas, area, graph) {
      canvas.save();
      canvas.beginPath();
      canvas.rect(area.x, area.y, area.w, area.h);
      canvas.clip();
      canvas.fillStyle = color('band', scheme());
      for (const band of plot.bands) {
        const left = graph.toDomXCoord(band.from);
        const width = Math.max(2, graph.toDomXCoord(band.to) - left);
        canvas.fillRect(left, area.y, width, area.h);
      }
      canvas.strokeStyle = color('noise', scheme());
      canvas.lineWidth = 1.5;
      canvas.setLineDash([6, 4]);
      for (const level of plot.levels) {
        const y = graph.toDomYCoord(level.value);
        canvas.beginPath();
        canvas.moveTo(area.x, y);
        canvas.lineTo(area.x + area.w, y);
        canvas.stroke();
      }
      canvas.restore();
    };
  }

  function entry(kind, tint, label, value) {
    const span = document.createElement('span');
    const line = document.createElement('i');
    line.className = kind;
    if (kind !== 'band') line.style.borderColor = tint;
    span.append(line, label);
    if (value !== undefined) {
      const bold = document.createElement('b');
      bold.textContent = ' ' + value;
      span.append(bold);
    }
    return span;
  }

  function legend(plot, scheme) {
    const unit = plot.unit ? ' ' + plot.unit : '';
    return function (data) {
      const box = document.createElement('div');
      for (const series of data.series) {
        const shown = data.x !== undefined && Number.isFinite(series.y);
        const value = shown ? number(series.y) + unit : undefined;
        box.append(entry('curve', series.color, series.label, value));
      }
      const labels = new Set(plot.levels.map((level) => level.label));
      labels.forEach((label) => {
        if (label) box.append(entry('level', color('noise', scheme()), label));
      });
      for (const band of plot.bands) {
        if (band.label) box.append(entry('band', '', band.label));
      }
      if (data.x !== undefined) {
        const at = document.createElement('span');
        at.textContent = 'at ' + number(data.x) +
            (plot.kind === 'spectrum' ? ' Hz' : ' s');
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
      colors: plot.curves.map((curve) => color(curve.role, scheme)),
      axisLineColor: color('quiet', scheme),
      gridLineColor: color('rule', scheme),
    };
  }

  function draw(figure, scheme) {
    const plot = JSON.parse(figure.querySelector('script').textContent);
    const spectrum = plot.kind === 'spectrum';
    const axis = {
      axisLabelFormatter: number,
      ticker: spectrum ? logarithmicTicks : Dygraph.numericLinearTicks,
    };
    const series = {};
    for (const curve of plot.curves) {
      // The simulated curve lies thin on the measured one, so that both stay visible.
      series[curve.label] = { strokeWidth: curve.role === 'measured' ? 2.5 : 1.2 };
    }
    const graph = new Dygraph(figure.querySelector('.chart'), rows(plot), Object.assign({
      labels: ['x'].concat(plot.curves.map((curve) => curve.label)),
      labelsDiv: figure.querySelector('.legend'),
      legend: 'always',
      legendFormatter: legend(plot, scheme),
      series: series,
      xlabel: plot.x_label,
      ylabel: plot.y_label,
      logscale: spectrum,
      axes: {
        x: Object.assign({ logscale: spectrum, pixelsPerLabel: 70 }, axis),
        y: Object.assign({ axisLabelWidth: 58, pixelsPerLabel: 26 }, axis),
      },
      axisLabelFontSize: 12,
      xLabelHeight: 20,
      yLabelWidth: 20,
      yRangePad: 8,
      rightGap: 12,
      highlightCircleSize: 3,
      interactionModel: touchFriendly(),
      underlayCallback: drawMarks(plot, scheme),
    }, colors(plot, scheme())));
    return { plot: plot, graph: graph };
  }

  const screen = document.documentElement;
  const paper = document.getElementById('paper');
  let scheme = screen;
  const charts = Array.from(document.querySelectorAll('figure.plot'),
      (figure) => draw(figure, () => scheme));

  function recolor() {
    for (const chart of charts) chart.graph.updateOptions(colors(chart.plot, scheme));
  }

  const timeGraphs = charts.filter((chart) => chart.plot.kind === 'time')
      .map((chart) => chart.graph);
  if (timeGraphs.length > 1) Dygraph.synchronize(timeGraphs, { range: false });

  document.getElementById('reset-zoom').addEventListener('click', () => {
    for (const chart of charts) chart.graph.resetZoom();
  });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolor);
  window.addEventListener('beforeprint', () => {
    scheme = paper;
    recolor();
  });
  window.addEventListener('afterprint', () => {
    scheme = screen;
    recolor();
  });
})();
