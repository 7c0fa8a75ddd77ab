// Plans: lines seen from above, north up, coloured by a value.
const drawPlan = (() => {
  const degrees = (value, [positive, negative]) =>
    `${Math.abs(value).toFixed(5)}° ${value < 0 ? negative : positive}`;

  // 1, 2 or 5 times a power of ten that is at least the value.
  function nice(value) {
    const power = 10 ** Math.floor(Math.log10(value));
    return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= value * 0.999);
  }

  // The class of a value: that of the first limit above it.
  const classOf = (colouring, value) => {
    const at = colouring.limits.findIndex((limit) => limit > value);
    return at < 0 ? colouring.limits.length : at;
  };

  function extent(lines) {
    const all = [Infinity, -Infinity, Infinity, -Infinity];
    for (const { places } of lines) {
      for (let i = 0; i < places.length; i += 2) {
        all[0] = Math.min(all[0], places[i]);
        all[1] = Math.max(all[1], places[i]);
        all[2] = Math.min(all[2], places[i + 1]);
        all[3] = Math.max(all[3], places[i + 1]);
      }
    }
    return all[0] > all[1] ? [-1, 1, -1, 1] : all;
  }

  // The point of a line at a distance: its index.
  function indexAt(line, km) {
    let [low, high] = [0, line.km.length - 1];
    if (high < 0 || km < line.km[0] || km > line.km[high]) return -1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (line.km[middle] <= km) low = middle;
      else high = middle;
    }
    return km - line.km[low] <= line.km[high] - km ? low : high;
  }

  class PlanView {
    constructor(box, spec) {
      Object.assign(this, { box, spec, shown: 0, ranges: new Map(), found: null });
      box.classList.add("plan");
      this.tools = element("div", box, { className: "tools" });
      this.canvas = element("canvas", box, {});
      this.readout = element("div", box, { className: "readout" });
      this.classes = element("ul", box, { className: "classes" });
      this.buttons();
      this.fit();
      this.listen();
      this.members = new Map();
      for (const link of new Set(spec.lines.map((line) => line.link))) {
        const member = {
          hover: (km) => this.show(this.placeAt(link, km)),
          range: (limits) => {
            this.ranges.set(link, limits);
            this.draw();
          },
        };
        this.members.set(link, member);
        links.join(link, member);
      }
    }

    buttons() {
      const { spec, tools } = this;
      if (spec.colourings.length > 1) {
        element("span", tools, { textContent: "colour by" });
        this.choices = spec.colourings.map((colouring, i) =>
          element("button", tools, {
            type: "button",
            textContent: colouring.name,
            onclick: () => ((this.shown = i), this.draw()),
          }),
        );
      }
      const button = (textContent, title, onclick) =>
        element("button", tools, { type: "button", textContent, title, ariaLabel: title, onclick });
      button("+", "zoom in", () => this.zoom(1.6));
      button("−", "zoom out", () => this.zoom(1 / 1.6));
      button("show all", "show all", () => (this.fit(), this.draw()));
    }

    // Sets the scale (pixels a metre) and the middle (m) so that everything is seen.
    fit() {
      const [west, east, south, north] = extent(this.spec.lines);
      this.width = this.box.clientWidth;
      const [wide, high] = [Math.max(east - west, 20), Math.max(north - south, 20)];
      this.height = Math.min(Math.max((this.width * high) / wide + 40, 260), Math.max(0.7 * innerHeight, 320), 560);
      this.scale = Math.min((this.width - 60) / wide, (this.height - 60) / high);
      this.middle = [(west + east) / 2, (south + north) / 2];
      this.isFitted = true;
    }

    x(east) {
      return this.width / 2 + (east - this.middle[0]) * this.scale;
    }

    y(north) {
      return this.height / 2 - (north - this.middle[1]) * this.scale;
    }

    zoom(by, [px, py] = [this.width / 2, this.height / 2]) {
      const [dx, dy] = [(px - this.width / 2) / this.scale, (this.height / 2 - py) / this.scale];
      this.middle = [this.middle[0] + dx * (1 - 1 / by), this.middle[1] + dy * (1 - 1 / by)];
      this.scale *= by;
      this.isFitted = false;
      this.draw();
    }

    draw() {
      const { canvas, width, height } = this;
      const ratio = devicePixelRatio;
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
      canvas.style.height = `${height}px`;
      const pen = canvas.getContext("2d");
      pen.scale(ratio, ratio);
      this.drawGrid(pen);
      this.drawRanges(pen);
      const colouring = this.spec.colourings[this.shown];
      pen.lineWidth = 3.5;
      pen.lineJoin = "round";
      for (const line of this.spec.lines) this.drawLine(pen, line, colouring);
      this.drawScale(pen);
      this.drawFound(pen);
      this.drawClasses(colouring);
    }

    // Screen positions of a line. Several lines move to their right, so that both directions show.
    path(line) {
      const aside = this.spec.lines.length > 1 ? 2 : 0;
      const { places } = line;
      const count = places.length / 2;
      const at = (i) => [this.x(places[2 * i]), this.y(places[2 * i + 1])];
      return Array.from({ length: count }, (_, i) => {
        const [x, y] = at(i);
        if (!aside) return [x, y];
        const [[ax, ay], [bx, by]] = [at(Math.max(i - 1, 0)), at(Math.min(i + 1, count - 1))];
        const length = Math.hypot(bx - ax, by - ay) || 1;
        return [x - (aside * (by - ay)) / length, y + (aside * (bx - ax)) / length];
      });
    }

    drawLine(pen, line, colouring) {
      const path = this.path(line);
      const values = line.values[this.shown] || [];
      let before = -1;
      for (let i = 0; i + 1 < path.length; i++) {
        const is = values[i] === null ? -1 : classOf(colouring, values[i]);
        if (is !== before) {
          if (before >= 0) pen.stroke();
          pen.strokeStyle = is < 0 ? "transparent" : ofPair(colouring.colours[is]);
          pen.beginPath();
          pen.moveTo(...path[i]);
        }
        pen.lineTo(...path[i + 1]);
        before = is;
      }
      if (before >= 0) pen.stroke();
    }

    // A halo along what the profile is zoomed to.
    drawRanges(pen) {
      pen.strokeStyle = isDark.matches ? "#6cb6ff66" : "#0a5ea844";
      pen.lineWidth = 13;
      for (const line of this.spec.lines) {
        const limits = this.ranges.get(line.link);
        if (!limits) continue;
        pen.beginPath();
        this.path(line).forEach(([x, y], i) => {
          if (line.km[i] >= limits[0] && line.km[i] <= limits[1]) pen.lineTo(x, y);
        });
        pen.stroke();
      }
    }

    // Meridians and parallels with their degrees.
    drawGrid(pen) {
      const { middle: origin, metres } = this.spec;
      pen.font = "11px system-ui, sans-serif";
      pen.lineWidth = 1;
      const grid = (perDegree, size, along, start, label) => {
        const step = nice(110 / (this.scale * perDegree));
        const digits = Math.max(0, -Math.floor(Math.log10(step)));
        const [low, high] = [along[0] / perDegree + start, along[1] / perDegree + start];
        for (let k = Math.ceil(low / step); k * step <= high; k++) {
          pen.strokeStyle = themed("--grid");
          pen.fillStyle = themed("--soft");
          label((k * step - start) * perDegree, k * step, digits);
        }
      };
      const [halfWide, halfHigh] = [this.width / 2 / this.scale, this.height / 2 / this.scale];
      const [mx, my] = this.middle;
      const name = (value, digits, sides) => `${Math.abs(value).toFixed(digits)}° ${sides[value < 0 ? 1 : 0]}`;
      grid(metres[1], this.width, [mx - halfWide, mx + halfWide], origin[1], (east, value, digits) => {
        pen.beginPath();
        pen.moveTo(this.x(east), 0);
        pen.lineTo(this.x(east), this.height);
        pen.stroke();
        pen.fillText(name(((value + 540) % 360) - 180, digits, "EW"), this.x(east) + 3, this.height - 5);
      });
      grid(metres[0], this.height, [my - halfHigh, my + halfHigh], origin[0], (north, value, digits) => {
        pen.beginPath();
        pen.moveTo(0, this.y(north));
        pen.lineTo(this.width, this.y(north));
        pen.stroke();
        pen.fillText(name(value, digits, "NS"), 4, this.y(north) - 3);
      });
    }

    drawScale(pen) {
      const metres = nice(50 / this.scale);
      const [right, y] = [this.width - 12, 18];
      pen.strokeStyle = pen.fillStyle = themed("--ink");
      pen.lineWidth = 1.5;
      pen.beginPath();
      pen.moveTo(right - metres * this.scale, y - 4);
      pen.lineTo(right - metres * this.scale, y);
      pen.lineTo(right, y);
      pen.lineTo(right, y - 4);
      pen.stroke();
      pen.textAlign = "right";
      pen.fillText(metres >= 1000 ? `${metres / 1000} km` : `${metres} m`, right, y + 14);
      pen.textAlign = "left";
    }

    drawFound(pen) {
      if (!this.found) return;
      const { line, index } = this.found;
      pen.beginPath();
      pen.arc(...this.path(line)[index], 6, 0, 2 * Math.PI);
      pen.fillStyle = themed("--back");
      pen.strokeStyle = themed("--ink");
      pen.lineWidth = 2.5;
      pen.fill();
      pen.stroke();
    }

    drawClasses(colouring) {
      (this.choices || []).forEach((button, i) => (button.ariaPressed = String(i === this.shown)));
      this.classes.textContent = "";
      colouring.classes.forEach((name, i) => {
        const item = element("li", this.classes, {});
        element("i", item, {}).style.background = ofPair(colouring.colours[i]);
        item.append(i === 0 && colouring.limits.length ? `${colouring.name} ${name}` : name);
      });
    }

    placeAt(link, km) {
      if (km === null) return null;
      for (const line of this.spec.lines) {
        if (line.link !== link) continue;
        const index = indexAt(line, km);
        if (index >= 0) return { line, index };
      }
      return null;
    }

    // The point nearest to the pointer, not farther than a finger is wide.
    nearest(px, py) {
      let [best, found] = [32 ** 2, null];
      for (const line of this.spec.lines) {
        for (let i = 0; i < line.km.length; i++) {
          const apart = (this.x(line.places[2 * i]) - px) ** 2 + (this.y(line.places[2 * i + 1]) - py) ** 2;
          if (apart < best) [best, found] = [apart, { line, index: i }];
        }
      }
      return found;
    }

    show(found) {
      this.found = found;
      this.draw();
      if (!found) {
        this.readout.textContent = "";
        return;
      }
      const { line, index } = found;
      const { middle, metres, colourings } = this.spec;
      const [east, north] = [line.places[2 * index], line.places[2 * index + 1]];
      const values = colourings.map((colouring, i) => {
        const value = line.values[i][Math.min(index, line.values[i].length - 1)];
        return `${colouring.name} ${short(value)} ${colouring.unit}`.trim();
      });
      const turned = ((middle[1] + east / metres[1] + 540) % 360) - 180;
      this.readout.textContent = [
        line.name,
        `${short(line.km[index])} km`,
        degrees(middle[0] + north / metres[0], "NS"),
        degrees(turned, "EW"),
        ...values,
      ].filter(Boolean).join(" · ");
    }

    pointAt(event) {
      const box = this.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    }

    hover(event) {
      const before = this.found;
      const found = this.nearest(...this.pointAt(event));
      this.show(found);
      if (before && (!found || before.line.link !== found.line.link)) this.tell(before.line.link, null);
      if (found) this.tell(found.line.link, found.line.km[found.index]);
    }

    tell(link, km) {
      links.tell(link, this.members.get(link), "hover", km);
    }

    listen() {
      const { canvas } = this;
      let held = null;
      canvas.onpointerdown = (event) => {
        if (event.pointerType === "mouse") {
          held = this.pointAt(event);
          canvas.setPointerCapture(event.pointerId);
        } else {
          this.hover(event);
        }
      };
      canvas.onpointermove = (event) => {
        if (!held) return this.hover(event);
        const at = this.pointAt(event);
        this.middle[0] -= (at[0] - held[0]) / this.scale;
        this.middle[1] += (at[1] - held[1]) / this.scale;
        held = at;
        this.isFitted = false;
        canvas.classList.add("held");
        this.draw();
      };
      canvas.onpointerup = canvas.onpointercancel = () => {
        held = null;
        canvas.classList.remove("held");
      };
      canvas.onpointerleave = () => {
        if (held) return;
        if (this.found) this.tell(this.found.line.link, null);
        this.show(null);
      };
      canvas.ondblclick = (event) => this.zoom(2, this.pointAt(event));
      // A plain wheel scrolls the page; with Ctrl, or as a pinch of a touch pad, it zooms.
      canvas.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.zoom(Math.exp(-event.deltaY / 200), this.pointAt(event));
      }, { passive: false });
      this.sized = new ResizeObserver(() => {
        if (this.box.clientWidth === this.width) return;
        if (this.isFitted) this.fit();
        this.width = this.box.clientWidth;
        this.draw();
      });
      this.sized.observe(this.box);
    }
  }

  return (box, spec) => {
    const view = new PlanView(box, spec);
    view.draw();
    return () => view.sized.disconnect();
  };
})();
