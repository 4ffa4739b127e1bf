// The page of a watch: what it says comes as events, what was comes from its history.
(function () {
  const byId = (id) => document.getElementById(id);
  const token = new URLSearchParams(location.search).get('token');

  function at(path, parameters) {
    const query = new URLSearchParams(parameters || {});
    if (token) query.set('token', token);
    const text = query.toString();
    return path + (text ? '?' + text : '');
  }

  function element(tag, text, className) {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (className) made.className = className;
    return made;
  }

  const finite = (value) => value !== null && Number.isFinite(value);

  // Six digits, if nobody says otherwise.
  function number(value, digits) {
    if (!finite(value)) return '–';
    return value === 0 ? '0' : String(parseFloat(value.toPrecision(digits || 6)));
  }

  function clock(time) {
    return new Date(1000 * time).toLocaleTimeString([], { hourCycle: 'h23' });
  }

  function moment(time) {
    const then = new Date(1000 * time);
    const today = new Date().toDateString() === then.toDateString();
    return today ? clock(time) : then.toLocaleDateString() + ' ' + clock(time);
  }

  function lasting(seconds) {
    const units = [['d', 86400], ['h', 3600], ['min', 60], ['s', 1]];
    let rest = Math.max(0, Math.floor(seconds));
    const parts = [];
    for (const [name, size] of units) {
      if (rest >= size || (name === 's' && parts.length === 0)) {
        parts.push(Math.floor(rest / size) + ' ' + name);
        rest %= size;
      }
      if (parts.length === 2) break;
    }
    return parts.join(' ');
  }

  function setText(node, text) {
    if (node.textContent !== text) node.textContent = text;
  }

  // ---- verdict

  const tones = {
    healthy: ['good', '✓'], fault: ['bad', '!'], unexplained: ['bad', '?'],
    disturbance: ['bad', '!'], noise: ['bad', '!'], residual: ['bad', '!'],
    settling: ['neutral', '…'],
  };

  function showVerdict(state) {
    const verdict = state.verdict;
    const none = verdict.kind === 'settling';
    const box = byId('verdict');
    const [tone, mark] = tones[verdict.kind] || tones.settling;
    const className = 'verdict ' + tone;
    if (box.className !== className) box.className = className;
    box.dataset.kind = verdict.kind;
    setText(box.querySelector('.mark'), mark);
    setText(box.querySelector('.words'), none ?
      'The diagnosis has not seen enough of the machine yet.' : verdict.words);
    if (none) return setText(byId('since'), '');
    let since = 'Since ' + moment(verdict.since) + ', ' +
        lasting(state.now - verdict.since) + '.';
    if (verdict.wrong_since > 0 && verdict.wrong_since < verdict.since - 1) {
      since += ' Something is wrong since ' + moment(verdict.wrong_since) + ', ' +
          lasting(state.now - verdict.wrong_since) + '.';
    }
    if (state.now - verdict.last > 3) {
      since += ' Last seen so at ' + moment(verdict.last) + '.';
    }
    setText(byId('since'), since);
    document.title = (tone === 'bad' ? '⚠ ' : '') + state.setup;
  }

  function showSource(state) {
    const source = state.source;
    const box = byId('source');
    const words = {
      waiting: 'Nothing has come in from ' + source.name + ' yet.',
      running: 'Ticks come in from ' + source.name + '.',
      silent: 'No ticks from ' + source.name + ' since ' + moment(source.last_tick) +
          ', ' + lasting(state.now - source.last_tick) + '.',
      other_rate: 'Ticks come in from ' + source.name +
          ' at another rate than the setup\'s; they are not judged.',
    };
    box.dataset.state = source.state;
    setText(box, words[source.state] || source.state);
    box.style.color = source.state === 'running' ? '' : 'var(--bad)';
    byId('notes').replaceChildren(...source.notes.map((note) => element('li', note)));
  }

  // ---- faults

  // The interval between the ends of what all of it reaches.
  function drawInterval(fault) {
    const box = element('span', undefined, 'interval');
    const [low, high] = fault.ci95;
    if (!finite(low) || !finite(high)) return box;
    const reach = Math.max(1e-9, 1.15 * Math.max(Math.abs(low - fault.healthy),
        Math.abs(high - fault.healthy), Math.abs(fault.value - fault.healthy)));
    const place = (value) => 50 + 50 * (value - fault.healthy) / reach;
    const line = element('i');
    line.style.left = place(low) + '%';
    line.style.width = Math.max(1, place(high) - place(low)) + '%';
    const mark = element('b');
    mark.style.left = place(fault.value) + '%';
    const healthy = element('u');
    healthy.style.left = '50%';
    box.append(healthy, line, mark);
    box.title = 'green: healthy, ' + number(fault.healthy);
    return box;
  }

  function showFaults(look) {
    const rows = look.faults.map((fault) => {
      const row = element('tr', undefined, fault.detected ? 'named' : '');
      row.dataset.fault = fault.name;
      const known = finite(fault.sd);
      row.append(
        element('td', fault.meaning ? fault.name + ', ' + fault.meaning : fault.name),
        element('td', known ? number(fault.value) : '–', 'number'),
        element('td', known ? '± ' + number((fault.ci95[1] - fault.ci95[0]) / 2, 2) :
            'not told so far', 'number'));
      const cell = element('td');
      if (known) cell.append(drawInterval(fault));
      row.append(cell);
      return row;
    });
    byId('faults').querySelector('tbody').replaceChildren(...rows);
  }

  function showDisturbance(look) {
    const seen = look.disturbance;
    let words = 'Not looked for yet.';
    if (seen.analysed) {
      words = seen.tones.length === 0 ? 'No tones.' :
          seen.tones.length === 1 ? 'One tone.' : seen.tones.length + ' tones.';
      words += ' Noise of the sensors: ' + number(seen.noise_ratio, 3) +
          ' times what is usual' + (seen.noise_raised ? ', raised.' : '.');
    }
    setText(byId('disturbance'), words);
    byId('tones').hidden = seen.tones.length === 0;
    byId('tones').querySelector('tbody').replaceChildren(...seen.tones.map((tone) => {
      const row = element('tr');
      for (const value of [tone.frequency, tone.psd, tone.threshold]) {
        row.append(element('td', number(value, 4), 'number'));
      }
      return row;
    }));
  }

  function showEvents(state) {
    const list = byId('events');
    const last = state.events[state.events.length - 1];
    const stamp = state.events.length + ':' + (last ? last.time : 0);
    if (list.dataset.stamp === stamp) return;
    list.dataset.stamp = stamp;
    list.replaceChildren(...state.events.slice().sort((a, b) => b.time - a.time).map((event) => {
      const item = element('li');
      item.append(element('time', moment(event.time)), event.words);
      return item;
    }));
  }

  function showCounts(state) {
    const source = state.source;
    const rows = [
      ['ticks judged', source.taken],
      ['missing', source.missing + ' in ' + source.gaps + ' gaps'],
      ['repeated, reordered, late', [source.repeated, source.reordered,
        source.late].join(', ')],
      ['of other senders', source.foreign],
      ['no ticks at all', source.nonsense + (source.last_nonsense ?
          ', the last: ' + source.last_nonsense : '')],
      ['lost on the way in', source.kernel + ' packets, ' + source.no_room + ' ticks'],
      ['runs of the sender, of the diagnosis', source.sender_runs + ', ' +
          source.diagnosis_runs],
      ['load', (100 * state.load.share).toFixed(1) + ' % of a core; ' +
          state.load.deepest + ' of ' + state.load.room + ' ticks have waited at most'],
      ['watching since', moment(state.started)],
    ];
    const cells = [];
    for (const [name, value] of rows) {
      cells.push(element('dt', name), element('dd', String(value)));
    }
    byId('counts').replaceChildren(...cells);
  }

  let picture = 0;
  function showPicture(state) {
    if (state.picture === picture) return;
    picture = state.picture;
    const figure = byId('picture');
    figure.hidden = picture === 0;
    document.querySelector('.top').classList.toggle('pictured', picture !== 0);
    if (picture === 0) return;
    figure.querySelector('img').src = at('picture.png', { v: picture });
    const names = state.verdict.faults.map((fault) => fault.name).join(', ');
    setText(figure.querySelector('figcaption'),
        names ? 'Marked: what ' + names + ' acts on.' : 'Nothing is marked.');
  }

  // ---- plots over time

  const color = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  let level = 0;
  let rows = null;  // of the level: { time, quantities }
  let limits = [null, null];
  const charts = new Map();

  function bars(name) {
    const values = rows.quantities[name];
    const table = [];
    for (let k = 0; k < rows.time.length; ++k) {
      // A stretch without ticks is a hole in the curve.
      if (k > 0 && rows.time[k] - rows.time[k - 1] > 2.5 * rows.width) {
        table.push([new Date(1000 * (rows.time[k - 1] + rows.width)), [NaN, NaN, NaN]]);
      }
      table.push([new Date(1000 * rows.time[k]), values(k)]);
    }
    return table;
  }

  function residualBars(k) {
    const residual = rows.quantities.residual;
    return [residual.min[k], residual.mean[k], residual.max[k]].map(
        (value) => value === null ? NaN : value);
  }

  // Of the estimate, with its own least and most where it moved more than that.
  const estimateBars = (name) => (k) => {
    const value = rows.quantities[name];
    const mean = value.mean[k];
    const sd = rows.quantities[name + ' sd'].mean[k];
    if (mean === null || sd === null) return [NaN, NaN, NaN];
    return [Math.min(value.min[k], mean - 1.96 * sd), mean,
      Math.max(value.max[k], mean + 1.96 * sd)];
  };

  function tableOf(values) {
    const saved = rows.quantities.now;
    rows.quantities.now = values;
    const table = bars('now');
    rows.quantities.now = saved;
    return table;
  }

  function drawLevels(levels) {
    return (canvas, area, graph) => {
      canvas.save();
      canvas.setLineDash([6, 4]);
      canvas.strokeStyle = color('noise');
      for (const value of levels()) {
        if (!finite(value)) continue;
        const y = graph.toDomYCoord(value);
        if (y < area.y || y > area.y + area.h) continue;
        canvas.beginPath();
        canvas.moveTo(area.x, y);
        canvas.lineTo(area.x + area.w, y);
        canvas.stroke();
      }
      canvas.restore();
    };
  }

  function makeChart(frame, table, levels, range) {
    return new Dygraph(frame, table, {
      labels: ['time', 'value'],
      customBars: true,
      fillAlpha: 0.3,
      legend: 'never',
      colors: [color('measured')],
      axisLineColor: color('quiet'),
      gridLineColor: color('rule'),
      axisLabelFontSize: 12,
      connectSeparatedPoints: false,
      axes: { y: { axisLabelWidth: 66, pixelsPerLabel: 26,
        axisLabelFormatter: (value) => number(value, 7) },
      x: { pixelsPerLabel: 80 } },
      yRangePad: 6,
      valueRange: range(),
      underlayCallback: drawLevels(levels),
      interactionModel: {},
      highlightCircleSize: 0,
    });
  }

  // The limits belong into the picture wherever the residual is.
  function residualRange() {
    if (!rows || !finite(limits[0]) || !finite(limits[1])) return null;
    let low = limits[0];
    let high = limits[1];
    rows.quantities.residual.min.forEach((value, k) => {
      const most = rows.quantities.residual.max[k];
      if (finite(value)) low = Math.min(low, value);
      if (finite(most)) high = Math.max(high, most);
    });
    const pad = 0.06 * (high - low);
    return [low - pad, high + pad];
  }

  function show(name, frame, values, levels, range) {
    const table = tableOf(values);
    if (table.length === 0) return;
    const chart = charts.get(name);
    if (chart) {
      chart.updateOptions({ file: table, valueRange: range() });
    } else {
      charts.set(name, makeChart(frame, table, levels, range));
    }
  }

  function drawAll(faults) {
    if (!rows || rows.time.length === 0) return;
    show('residual', document.querySelector('#residual .chart'), residualBars,
        () => limits, residualRange);
    const box = byId('estimates');
    for (const fault of faults) {
      let figure = box.querySelector('[data-fault="' + CSS.escape(fault.name) + '"]');
      if (!figure) {
        figure = element('figure');
        figure.dataset.fault = fault.name;
        figure.append(element('figcaption', fault.name +
            (fault.meaning ? ', ' + fault.meaning : '')), element('div', undefined, 'chart'));
        box.append(figure);
      }
      show('fault ' + fault.name, figure.querySelector('.chart'),
          estimateBars(fault.name), () => [fault.healthy], () => null);
    }
  }

  function append(fresh) {
    if (!rows || rows.width !== fresh.width) {
      rows = fresh;
      return;
    }
    if (fresh.time.length === 0) return;
    let keep = rows.time.length;
    while (keep > 0 && rows.time[keep - 1] >= fresh.time[0]) --keep;
    const reach = fresh.time[fresh.time.length - 1] - [900, 10800, 172800, 3628800][level];
    let drop = 0;
    while (drop < keep && rows.time[drop] < reach) ++drop;
    const join = (old, more) => old.slice(drop, keep).concat(more);
    rows.time = join(rows.time, fresh.time);
    for (const name of Object.keys(fresh.quantities)) {
      const values = rows.quantities[name];
      for (const part of ['min', 'mean', 'max']) {
        values[part] = join(values[part], fresh.quantities[name][part]);
      }
    }
  }

  let latest = null;
  let asked = 0;
  function refresh() {
    const wanted = level;
    const from = rows && rows.time.length > 0 ? rows.time[rows.time.length - 1] : 0;
    asked = Date.now();
    return fetch(at('history.json', { level: wanted, from: from }))
        .then((response) => response.ok ? response.json() : Promise.reject(response.status))
        .then((fresh) => {
          if (wanted !== level) return;
          append(fresh);
          if (latest && latest.look) drawAll(latest.look.faults);
        }).catch(() => {});
  }

  for (const button of document.querySelectorAll('.range button')) {
    button.addEventListener('click', () => {
      document.querySelectorAll('.range button').forEach((other) =>
        other.setAttribute('aria-pressed', other === button));
      level = Number(button.dataset.level);
      rows = null;
      refresh();
    });
  }

  // ---- events

  let heard = Date.now();
  function take(state) {
    heard = Date.now();
    latest = state;
    showVerdict(state);
    showSource(state);
    showEvents(state);
    showCounts(state);
    showPicture(state);
    if (!state.look) return;
    limits = state.look.residual.limits;
    showFaults(state.look);
    showDisturbance(state.look);
    const every = [1000, 5000, 20000, 60000][level];
    if (Date.now() - asked > every) refresh();
  }

  function watchTheWatch() {
    const silent = Date.now() - heard > 4000;
    document.body.classList.toggle('stale', silent);
    byId('lost').hidden = !silent;
    if (silent) {
      setText(byId('lost'), 'The watch does not answer. What stands here is of ' +
          moment(heard / 1000) + '.');
    }
  }

  function connect() {
    const events = new EventSource(at('events'));
    events.addEventListener('state', (event) => take(JSON.parse(event.data)));
    events.onerror = () => {
      // A refusal ends it for good; an end of the watch does not.
      if (events.readyState !== EventSource.CLOSED) return;
      setTimeout(connect, 3000);
    };
  }

  document.querySelector('h1').textContent = document.title;
  fetch(at('state.json')).then((response) => response.json()).then(take).catch(() => {});
  connect();
  setInterval(watchTheWatch, 1000);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    for (const chart of charts.values()) {
      chart.updateOptions({ colors: [color('measured')], axisLineColor: color('quiet'),
        gridLineColor: color('rule') });
    }
  });
})();
