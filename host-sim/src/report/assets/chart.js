// Charts: series over a common axis, drawn by uPlot.
const drawChart = (() => {
  function axis(label, size, isNarrow, isWhole) {
    const font = `${isNarrow ? 11 : 12}px system-ui, sans-serif`;
    const grid = { stroke: themed("--grid"), width: 1 };
    return {
      label, size, font, grid, ticks: { ...grid, size: 5 }, stroke: themed("--ink"),
      labelFont: font, labelSize: isNarrow ? 16 : 20, labelGap: 0,
      ...(isWhole ? { incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000] } : {}),
      values: (u, splits) => splits.map((value) => (value === null ? "" : short(value))),
    };
  }

  // The whole range of x, with room for half a bar on either side.
  function fullRange(xs, hasBars) {
    const [first, last] = [xs[0] || 0, xs[xs.length - 1] || 0];
    const pad = xs.length < 2 ? 0.5 : hasBars ? (xs[1] - first) / 2 : 0;
    return { limits: [first - pad, last + pad], covers: ([low, high]) => low <= first && high >= last };
  }

  class Chart {
    constructor(box, spec) {
      const { data, at } = chartSeries.columns(spec);
      Object.assign(this, { box, spec, at, isLed: false });
      this.full = fullRange(data[0], spec.series.some((of) => of.mark === "bars"));
      this.told = this.full.limits;
      this.buttons();
      this.u = new uPlot(this.options(data[0]), data, box);
      this.panByTouch();
      links.join(spec.link, this);
      this.sized = new ResizeObserver(() => {
        const { u } = this;
        if (box.clientWidth && box.clientWidth !== u.width) u.setSize({ width: box.clientWidth, height: u.height });
      });
      this.sized.observe(box);
    }

    buttons() {
      const tools = element("div", this.box, { className: "tools" });
      const button = (textContent, title, onclick) =>
        element("button", tools, { type: "button", textContent, title, ariaLabel: title, onclick });
      element("span", tools, { textContent: "drag to zoom", className: "for-mouse" });
      button("+", "zoom in", () => this.zoom(1 / 2));
      button("−", "zoom out", () => this.zoom(2));
      this.reset = button("show all", "show all", () => this.set(this.full.limits));
      this.reset.disabled = true;
    }

    options(xs) {
      const { box, spec, at } = this;
      const isNarrow = box.clientWidth < 560;
      const isWhole = xs.length < 5000 && xs.every(Number.isInteger);
      const range = (u, min, max) => (min === null || this.full.covers([min, max]) ? this.full.limits : [min, max]);
      return {
        ...chartSeries.allSeries(spec, at),
        hooks: this.hooks(),
        width: box.clientWidth,
        height: Math.round(Math.max(spec.height, 160) * (isNarrow ? 0.85 : 1)),
        padding: [8, 12, 0, 0],
        scales: { x: { time: false, range }, y: spec.range ? { range: () => spec.range } : {} },
        axes: [axis(spec.x, 32, isNarrow, isWhole), axis(spec.y, isNarrow ? 46 : 56, isNarrow)],
        cursor: {
          y: false,
          drag: { x: true, y: false, setScale: true },
          dataIdx: chartSeries.nearest,
          points: { size: 7 },
        },
        legend: { live: true, markers: chartSeries.markers(spec, at) },
      };
    }

    hooks() {
      const { spec, at } = this;
      return {
        drawClear: [(u) => chartMarks.drawShaded(u, spec)],
        draw: [(u) => chartMarks.drawTicks(u, spec), (u) => spec.range && chartMarks.drawBeyond(u, spec, at)],
        setCursor: [
          (u) => {
            const { left } = u.cursor;
            if (!this.isLed) links.tell(spec.link, this, "hover", left >= 0 ? u.posToVal(left, "x") : null);
          },
        ],
        setScale: [
          (u, key) => {
            const { min, max } = u.scales[key];
            if (key !== "x" || min === null || (min === this.told[0] && max === this.told[1])) return;
            this.told = [min, max];
            this.reset.disabled = this.full.covers(this.told);
            links.tell(spec.link, this, "range", this.reset.disabled ? null : this.told);
          },
        ],
        // Both edges of a band go together.
        setSeries: [
          (u, i, change) => {
            if (i && u.series[i].isBand && "show" in change) u.setSeries(i + 1, { show: change.show }, false);
          },
        ],
      };
    }

    // Shows the place that another figure tells.
    hover(x) {
      this.isLed = true;
      this.u.setCursor(x === null ? { left: -10, top: -10 } : { left: this.u.valToPos(x, "x"), top: 10 });
      this.isLed = false;
    }

    // Shows a range of x; null: everything.
    range(limits) {
      const [min, max] = (this.told = limits || this.full.limits);
      this.reset.disabled = this.full.covers(this.told);
      this.u.setScale("x", { min, max });
    }

    // Shows a range of x, here and in all that is linked. It stays within the data.
    set([low, high]) {
      const [first, last] = this.full.limits;
      const wide = Math.min(high - low, last - first);
      const from = Math.min(Math.max(low, first), last - wide);
      const limits = wide < last - first ? [from, from + wide] : null;
      this.range(limits);
      links.tell(this.spec.link, this, "range", limits);
    }

    // Zooms about the pointer, else about the middle.
    zoom(by) {
      const [low, high] = this.told;
      const { left } = this.u.cursor;
      const middle = left >= 0 ? this.u.posToVal(left, "x") : (low + high) / 2;
      this.set([middle - ((high - low) / 2) * by, middle + ((high - low) / 2) * by]);
    }

    // A finger that moves sideways over a zoomed chart moves it; else it shows values.
    panByTouch() {
      const { over } = this.u;
      let held = null;
      over.addEventListener("pointerdown", (event) => {
        const isMouse = event.pointerType === "mouse";
        held = isMouse || this.full.covers(this.told) ? null : { x: event.clientX, range: this.told };
      });
      over.addEventListener("pointermove", (event) => {
        if (event.pointerType === "mouse") return;
        if (held) {
          const [low, high] = held.range;
          const by = ((held.x - event.clientX) / over.clientWidth) * (high - low);
          this.set([low + by, high + by]);
        } else {
          const box = over.getBoundingClientRect();
          this.u.setCursor({ left: event.clientX - box.left, top: event.clientY - box.top });
        }
      });
      for (const end of ["pointerup", "pointercancel"]) over.addEventListener(end, () => (held = null));
    }

    stop() {
      this.sized.disconnect();
      this.u.destroy();
    }
  }

  return (box, spec) => {
    const chart = new Chart(box, spec);
    return () => chart.stop();
  };
})();
