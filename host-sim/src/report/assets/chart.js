// Charts: series over a common axis, drawn by uPlot.
const drawChart = (() => {
  const faint = (colour) => colour + "38";

  // uPlot wants one column of x. What a series does not have there is undefined, and drawn through.
  function columns(spec) {
    const tables = spec.axes.map((axis) => [axis]);
    const at = spec.series.map((series) => {
      const table = tables[series.axis];
      const first = table.push(series.y) - 1;
      if (series.mark === "band") table.push(series.lower);
      return first;
    });
    const before = [];
    tables.reduce((sum, table, i) => ((before[i] = sum), sum + table.length - 1), 0);
    return {
      data: tables.length === 1 ? tables[0] : uPlot.join(tables),
      at: spec.series.map((series, i) => before[series.axis] + at[i]),
    };
  }

  // The index nearest to the pointer at which the series has a point.
  function nearest(u, series, index, x) {
    const [xs, ys] = [u.data[0], u.data[series]];
    if (ys[index] !== undefined) return index;
    let [low, high] = [index, index];
    while (low > 0 && ys[low] === undefined) low--;
    while (high < ys.length - 1 && ys[high] === undefined) high++;
    if (ys[low] === undefined) return high;
    if (ys[high] === undefined) return low;
    return x - xs[low] <= xs[high] - x ? low : high;
  }

  function seriesOptions(spec, index) {
    const series = spec.series[index];
    const colour = ofPair(series.colour);
    const common = {
      label: series.name || spec.y,
      width: 1.75,
      value: (u, value) => short(value),
      points: { show: false },
    };
    switch (series.mark) {
      case "dashed":
        return { ...common, stroke: colour, dash: [7, 5] };
      case "dots":
        return { ...common, stroke: colour, paths: () => null, points: { show: true, size: 5, fill: colour, width: 0 } };
      case "bars":
        return { ...common, stroke: colour, fill: faint(colour), width: 1, paths: uPlot.paths.bars({ size: [1, Infinity] }) };
      case "band":
        return { ...common, stroke: "transparent", fill: faint(colour), isBand: true };
      default:
        return { ...common, stroke: colour };
    }
  }

  // All series of uPlot, where they are in its data, and its bands.
  function allSeries(spec, at) {
    const options = [{ label: spec.x, value: (u, value) => short(value) }];
    const bands = [];
    spec.series.forEach((series, i) => {
      options[at[i]] = { ...seriesOptions(spec, i), class: `is-${series.mark}` };
      if (series.mark !== "band") return;
      const edge = { label: "", class: "hidden", stroke: "transparent", points: { show: false } };
      options[at[i] + 1] = edge;
      options[at[i]].value = (u, upper, si, index) =>
        upper === null || upper === undefined || index === null
          ? "–"
          : `${short(u.data[si + 1][index])} to ${short(upper)}`;
      bands.push({ series: [at[i], at[i] + 1], fill: faint(ofPair(series.colour)) });
    });
    return { options, bands };
  }

  // Keys of the legend look as what they name: a line, a dashed line, an area.
  function markers(spec, at) {
    const of = (i) => spec.series[at.indexOf(i)];
    const colour = (i) => (of(i) ? ofPair(of(i).colour) : "transparent");
    const isArea = (i) => of(i) && (of(i).mark === "band" || of(i).mark === "bars");
    return {
      width: 0,
      stroke: () => "transparent",
      fill: (u, i) =>
        isArea(i) ? faint(colour(i))
        : of(i) && of(i).mark === "dashed"
          ? `repeating-linear-gradient(to right, ${colour(i)} 0 .45em, transparent .45em .7em)`
          : colour(i),
    };
  }

  // Grey where the data say so; drawn below the curves.
  function drawShaded(u, spec) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = "#99999940";
    for (const [from, to] of spec.shaded) {
      const left = u.valToPos(from, "x", true);
      ctx.fillRect(left, bbox.top, Math.max(u.valToPos(to, "x", true) - left, 1), bbox.height);
    }
    ctx.restore();
  }

  function drawTicks(u, spec) {
    const { ctx, bbox } = u;
    ctx.fillStyle = themed("--ink");
    for (const tick of spec.ticks) {
      const x = u.valToPos(tick, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      const height = 0.08 * bbox.height;
      ctx.fillRect(x, bbox.top + bbox.height - height, devicePixelRatio, height);
    }
  }

  // A triangle at the edge where a curve leaves the axis: one for each stay beyond it.
  function drawBeyond(u, spec, at) {
    const { min, max } = u.scales.y;
    const size = 6 * devicePixelRatio;
    spec.series.forEach((series, i) => {
      if (series.mark === "band" || !u.series[at[i]].show) return;
      u.ctx.fillStyle = ofPair(series.colour);
      const [xs, ys] = [u.data[0], u.data[at[i]]];
      let was = 0;
      for (let k = u.series[0].idxs[0]; k <= u.series[0].idxs[1]; k++) {
        if (ys[k] === undefined) continue;
        const is = ys[k] === null ? 0 : ys[k] > max ? 1 : ys[k] < min ? -1 : 0;
        if (is && is !== was) triangle(u, u.valToPos(xs[k], "x", true), is, size);
        was = is;
      }
    });
  }

  function triangle(u, x, up, size) {
    const edge = up > 0 ? u.bbox.top : u.bbox.top + u.bbox.height;
    u.ctx.beginPath();
    u.ctx.moveTo(x, edge);
    u.ctx.lineTo(x - size / 1.6, edge + up * size);
    u.ctx.lineTo(x + size / 1.6, edge + up * size);
    u.ctx.fill();
  }

  function axis(label, size, isNarrow) {
    const font = `${isNarrow ? 11 : 12}px system-ui, sans-serif`;
    const grid = { stroke: themed("--grid"), width: 1 };
    return {
      label, size, font, grid, ticks: { ...grid, size: 5 }, stroke: themed("--ink"),
      labelFont: font, labelSize: isNarrow ? 18 : 22, labelGap: 0,
      values: (u, splits) => splits.map((value) => (value === null ? "" : short(value))),
    };
  }

  // A finger that moves sideways over a zoomed chart moves it; else it shows values.
  function panByTouch(u, range, set, isFull) {
    let held = null;
    u.over.addEventListener("pointerdown", (event) => {
      held = event.pointerType === "mouse" || isFull(range()) ? null : { x: event.clientX, range: range() };
    });
    u.over.addEventListener("pointermove", (event) => {
      if (event.pointerType === "mouse") return;
      if (held) {
        const [low, high] = held.range;
        const by = ((held.x - event.clientX) / u.over.clientWidth) * (high - low);
        set([low + by, high + by]);
      } else {
        const box = u.over.getBoundingClientRect();
        u.setCursor({ left: event.clientX - box.left, top: event.clientY - box.top });
      }
    });
    u.over.addEventListener("pointerup", () => (held = null));
    u.over.addEventListener("pointercancel", () => (held = null));
  }

  return (box, spec) => {
    const tools = element("div", box, { className: "tools" });
    const button = (textContent, title, onclick) =>
      element("button", tools, { type: "button", textContent, title, ariaLabel: title, onclick });
    element("span", tools, { textContent: "drag to zoom", className: "for-mouse" });
    button("+", "zoom in", () => zoom(1 / 2));
    button("−", "zoom out", () => zoom(2));
    const reset = button("show all", "show all", () => told !== full && set(full));
    reset.disabled = true;
    const { data, at } = columns(spec);
    const { options: series, bands } = allSeries(spec, at);
    const xs = data[0];
    const isBars = spec.series.some((of) => of.mark === "bars");
    const pad = isBars && xs.length > 1 ? (xs[1] - xs[0]) / 2 : 0;
    const full = xs.length > 1 ? [xs[0] - pad, xs[xs.length - 1] + pad] : [(xs[0] || 0) - 0.5, (xs[0] || 0) + 0.5];
    const isFull = ([low, high]) => low <= full[0] && high >= full[1];
    const isNarrow = box.clientWidth < 560;
    const height = Math.round(Math.max(spec.height, 160) * (isNarrow ? 0.85 : 1));
    let [told, isLed] = [full, false];

    const member = {
      hover(x) {
        isLed = true;
        u.setCursor(x === null ? { left: -10, top: -10 } : { left: u.valToPos(x, "x"), top: 10 });
        isLed = false;
      },
      range(limits) {
        const [min, max] = (told = limits || full);
        reset.disabled = isFull(told);
        u.setScale("x", { min, max });
      },
    };
    // Shows a range of x, here and in all that is linked. It stays within the data.
    const set = ([low, high]) => {
      const wide = Math.min(high - low, full[1] - full[0]);
      const from = Math.min(Math.max(low, full[0]), full[1] - wide);
      const limits = wide < full[1] - full[0] ? [from, from + wide] : null;
      member.range(limits);
      links.tell(spec.link, member, "range", limits);
    };
    // Zooms about the pointer, else about the middle.
    const zoom = (by) => {
      const { left } = u.cursor;
      const middle = left >= 0 ? u.posToVal(left, "x") : (told[0] + told[1]) / 2;
      set([middle - ((told[1] - told[0]) / 2) * by, middle + ((told[1] - told[0]) / 2) * by]);
    };
    const hooks = {
      drawClear: [(of) => drawShaded(of, spec)],
      draw: [(of) => drawTicks(of, spec), (of) => spec.range && drawBeyond(of, spec, at)],
      setCursor: [
        (of) => {
          const { left } = of.cursor;
          if (!isLed) links.tell(spec.link, member, "hover", left >= 0 ? of.posToVal(left, "x") : null);
        },
      ],
      setScale: [
        (of, key) => {
          const { min, max } = of.scales[key];
          if (key !== "x" || min === null || (min === told[0] && max === told[1])) return;
          told = [min, max];
          reset.disabled = isFull(told);
          links.tell(spec.link, member, "range", isFull(told) ? null : told);
        },
      ],
      // Both edges of a band go together.
      setSeries: [
        (of, i, change) => {
          if (i && of.series[i].isBand && "show" in change) of.setSeries(i + 1, { show: change.show }, false);
        },
      ],
    };
    const u = new uPlot(
      {
        width: box.clientWidth, height, series, bands, hooks,
        padding: [8, 12, 0, 0],
        scales: {
          x: { time: false, range: (of, min, max) => (min === null || isFull([min, max]) ? full : [min, max]) },
          y: spec.range ? { range: () => spec.range } : {},
        },
        axes: [axis(spec.x, isNarrow ? 40 : 48, isNarrow), axis(spec.y, isNarrow ? 56 : 66, isNarrow)],
        cursor: { y: false, drag: { x: true, y: false, setScale: true }, dataIdx: nearest, points: { size: 7 } },
        legend: { live: true, markers: markers(spec, at) },
      },
      data,
      box,
    );
    panByTouch(u, () => told, set, isFull);
    links.join(spec.link, member);
    const sized = new ResizeObserver(() => {
      if (box.clientWidth && box.clientWidth !== u.width) u.setSize({ width: box.clientWidth, height });
    });
    sized.observe(box);
    return () => {
      sized.disconnect();
      u.destroy();
    };
  };
})();
