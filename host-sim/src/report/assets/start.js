// Draws the figures of the page, again when the theme changes.
(() => {
  let stops = [];
  function drawAll() {
    for (const stop of stops) stop();
    links.leaveAll();
    stops = [...document.querySelectorAll(".drawing")].map((box) => {
      box.textContent = "";
      const spec = JSON.parse(document.getElementById(box.dataset.of).textContent);
      return spec.kind === "plan" ? drawPlan(box, spec) : drawChart(box, spec);
    });
  }
  drawAll();
  isDark.addEventListener("change", drawAll);
})();
