'use strict';
// A time series in as many rows as a screen can show. Where several samples share a
// pixel they become two rows, their smallest and their largest value in the order in
// which they come, so that no peak is lost; where there is room, every sample is a row.
const sampling = (function () {
  // Rows for the part of the record outside of what is shown, on either side.
  const kOutside = 250;

  const value = (y) => (Number.isFinite(y) ? y : null);

  function exactRow(plot, k) {
    return [plot.start + k * plot.step].concat(plot.curves.map((c) => value(c.samples[k])));
  }

  // Samples from .. to - 1 in buckets of that size.
  function addBuckets(table, plot, from, to, size) {
    if (size <= 2) {
      for (let k = from; k < to; ++k) table.push(exactRow(plot, k));
      return;
    }
    for (let begin = from; begin < to; begin += size) {
      const end = Math.min(begin + size, to);
      const early = [plot.start + begin * plot.step];
      const late = [plot.start + (begin + (end - begin) / 2) * plot.step];
      for (const curve of plot.curves) {
        let low = -1;
        let high = -1;
        for (let k = begin; k < end; ++k) {
          const y = curve.samples[k];
          if (!Number.isFinite(y)) continue;
          if (low < 0 || y < curve.samples[low]) low = k;
          if (high < 0 || y > curve.samples[high]) high = k;
        }
        early.push(low < 0 ? null : curve.samples[Math.min(low, high)]);
        late.push(low < 0 ? null : curve.samples[Math.max(low, high)]);
      }
      table.push(early, late);
    }
  }

  // window: [from, to] in seconds, or null for all. pixels: across the plot.
  function rows(plot, window, pixels) {
    const table = [];
    const count = plot.curves.length > 0 ? plot.curves[0].samples.length : 0;
    if (count === 0) return table;
    // The last sample is a row of its own: rows reach as far as the record.
    const last = count - 1;
    const index = (time) => Math.min(last, Math.max(0, (time - plot.start) / plot.step));
    const from = window ? Math.floor(index(window[0])) : 0;
    const to = window ? Math.min(last, Math.ceil(index(window[1])) + 1) : last;
    addBuckets(table, plot, 0, from, Math.ceil(from / kOutside));
    addBuckets(table, plot, from, to, Math.floor((to - from) / Math.max(1, pixels)));
    addBuckets(table, plot, to, last, Math.ceil((last - to) / kOutside));
    table.push(exactRow(plot, last));
    return table;
  }

  // The row that is nearest to a time; -1 outside of the record.
  function nearest(table, time) {
    if (table.length === 0 || time < table[0][0] || time > table[table.length - 1][0]) {
      return -1;
    }
    let low = 0;
    let high = table.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (table[middle][0] <= time) low = middle;
      else high = middle;
    }
    return time - table[low][0] < table[high][0] - time ? low : high;
  }

  return { rows: rows, nearest: nearest };
})();
