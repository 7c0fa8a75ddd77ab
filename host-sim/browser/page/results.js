// Shows the results of a job: a line for each run, the files, and the page of the map.
const showResults = (() => {
  const COLUMNS = [
    ["verdict", (of) => of.verdict],
    ["km", (of) => of.distance_km.toFixed(2)],
    ["sigma %", (of) => of.grade_sigma_percent.toFixed(3)],
    ["valid %", (of) => of.valid_percent.toFixed(1)],
    ["mass kg", (of) => (of.mass_kg === null ? "" : `${of.mass_kg.toFixed(0)} ± ${of.mass_sigma_kg.toFixed(0)}`)],
  ];
  const KINDS = { csv: "text/csv", html: "text/html", toml: "text/plain" };
  let urls = [];

  const add = (parent, name, properties) =>
    parent.appendChild(Object.assign(document.createElement(name), properties));

  function showRuns(table, runs) {
    table.textContent = "";
    const head = add(add(table, "thead"), "tr");
    for (const name of ["run", ...COLUMNS.map(([name]) => name)]) {
      add(head, "th", { scope: "col", textContent: name });
    }
    const body = add(table, "tbody");
    for (const { run, summary } of runs) {
      const row = add(body, "tr");
      add(row, "td", { textContent: run });
      for (const [, text] of COLUMNS) add(row, "td", { textContent: text(summary) });
    }
  }

  function showWarnings(box, { runs, left_out }) {
    box.textContent = "";
    const note = (message, advice) => {
      const shown = add(box, "div", { className: "note warning" });
      add(shown, "b", { textContent: "Warning: " });
      shown.append(message);
      if (advice) add(shown, "span", { textContent: advice });
    };
    for (const problem of left_out) note(`left out: ${problem}`);
    for (const { run, summary } of runs) {
      for (const { message, advice } of summary.warnings) note(`${run}: ${message}`, advice);
    }
  }

  function size(bytes) {
    return bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
  }

  function showDownloads(list, files) {
    urls.forEach((url) => URL.revokeObjectURL(url));
    list.textContent = "";
    urls = files.map(([path, bytes]) => {
      const type = KINDS[path.split(".").pop()] ?? "";
      const url = URL.createObjectURL(new Blob([bytes], { type }));
      const download = path.split("/").pop();
      const link = add(add(list, "li"), "a", { href: url, download, textContent: `${download} ` });
      link.dataset.path = path;
      add(link, "span", { textContent: size(bytes.length) });
      return url;
    });
  }

  // The page of the map as a part of this one: as high as its content.
  function showReport(frame, html) {
    frame.onload = () => {
      const content = frame.contentDocument?.documentElement;
      if (!content) return;
      const fit = () => (frame.style.height = `${content.getBoundingClientRect().height + 4}px`);
      new ResizeObserver(fit).observe(content);
      fit();
    };
    frame.srcdoc = html;
  }

  return (files) => {
    const texts = new Map(files);
    const text = (path) => new TextDecoder().decode(texts.get(path));
    const byId = (id) => document.getElementById(id);
    const summary = JSON.parse(text("summary.json"));
    showRuns(byId("runs"), summary.runs);
    showWarnings(byId("left_out"), summary);
    // The runs come first: they are what most are here for.
    const order = (path) => (path.startsWith("runs/") ? 0 : 1);
    showDownloads(byId("downloads"), [...files].sort(([a], [b]) => order(a) - order(b)));
    byId("results").hidden = false;
    showReport(byId("report"), text("index.html"));
  };
})();
