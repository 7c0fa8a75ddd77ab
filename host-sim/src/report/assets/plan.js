// Plans: lines seen from above, north up, coloured by a value.
const drawPlan = (() => {
  const degrees = (value, [positive, negative]) =>
    `${Math.abs(value).toFixed(5)}° ${value < 0 ? negative : positive}`;

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

  class Plan {
    constructor(box, spec) {
      box.classList.add("plan");
      Object.assign(this, { box, spec });
      this.tools = element("div", box, { className: "tools" });
      this.view = new PlanView(box, spec);
      this.buttons();
      this.link();
      this.listen();
      this.view.draw();
    }

    buttons() {
      const { spec, tools, view } = this;
      if (spec.colourings.length > 1) element("span", tools, { textContent: "colour by" });
      const choices = spec.colourings.length < 2 ? [] : spec.colourings.map((colouring, i) =>
        element("button", tools, { type: "button", textContent: colouring.name, onclick: () => choose(i) }),
      );
      const choose = (shown) => {
        choices.forEach((button, i) => (button.ariaPressed = String(i === shown)));
        view.shown = shown;
        view.draw();
      };
      const button = (textContent, title, onclick) =>
        element("button", tools, { type: "button", textContent, title, ariaLabel: title, onclick });
      button("+", "zoom in", () => view.zoom(1.6));
      button("−", "zoom out", () => view.zoom(1 / 1.6));
      button("show all", "show all", () => (view.fit(), view.draw()));
      choose(0);
    }

    // Joins what each of its lines shares with the profiles along it.
    link() {
      this.members = new Map();
      for (const link of new Set(this.spec.lines.map((line) => line.link))) {
        const member = {
          hover: (km) => this.show(this.placeAt(link, km)),
          range: (limits) => {
            this.view.ranges.set(link, limits);
            this.view.draw();
          },
        };
        this.members.set(link, member);
        links.join(link, member);
      }
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
      const { view } = this;
      let [best, found] = [32 ** 2, null];
      for (const line of this.spec.lines) {
        for (let i = 0; i < line.km.length; i++) {
          const apart = (view.x(line.places[2 * i]) - px) ** 2 + (view.y(line.places[2 * i + 1]) - py) ** 2;
          if (apart < best) [best, found] = [apart, { line, index: i }];
        }
      }
      return found;
    }

    show(found) {
      const { view } = this;
      view.found = found;
      view.draw();
      if (!found) {
        view.readout.textContent = "";
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
      view.readout.textContent = [
        line.name,
        `${short(line.km[index])} km`,
        degrees(middle[0] + north / metres[0], "NS"),
        degrees(turned, "EW"),
        ...values,
      ].filter(Boolean).join(" · ");
    }

    pointAt(event) {
      const box = this.view.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    }

    hover(event) {
      const before = this.view.found;
      const found = this.nearest(...this.pointAt(event));
      this.show(found);
      if (before && (!found || before.line.link !== found.line.link)) this.tell(before.line.link, null);
      if (found) this.tell(found.line.link, found.line.km[found.index]);
    }

    tell(link, km) {
      links.tell(link, this.members.get(link), "hover", km);
    }

    listen() {
      const { view } = this;
      const { canvas } = view;
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
        view.middle[0] -= (at[0] - held[0]) / view.scale;
        view.middle[1] += (at[1] - held[1]) / view.scale;
        held = at;
        view.isFitted = false;
        canvas.classList.add("held");
        view.draw();
      };
      canvas.onpointerup = canvas.onpointercancel = () => {
        held = null;
        canvas.classList.remove("held");
      };
      canvas.onpointerleave = () => {
        if (held) return;
        if (view.found) this.tell(view.found.line.link, null);
        this.show(null);
      };
      canvas.ondblclick = (event) => view.zoom(2, this.pointAt(event));
      // A plain wheel scrolls the page; with Ctrl, or as a pinch of a touch pad, it zooms.
      canvas.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        view.zoom(Math.exp(-event.deltaY / 200), this.pointAt(event));
      }, { passive: false });
      this.sized = new ResizeObserver(() => {
        if (this.box.clientWidth === view.width) return;
        if (view.isFitted) view.fit();
        view.width = this.box.clientWidth;
        view.draw();
      });
      this.sized.observe(this.box);
    }
  }

  return (box, spec) => {
    const plan = new Plan(box, spec);
    return () => plan.sized.disconnect();
  };
})();
