// What the page does beside its plot: the switch between dark and light, and details opened for print.
(function () {
  "use strict";
  const root = document.documentElement;
  root.classList.add("js");
  const button = document.getElementById("theme");
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const KEY = "spacerobot-theme";

  function stored() {
    try { return localStorage.getItem(KEY); } catch (error) { return null; }
  }
  function dark() {
    return root.dataset.theme ? root.dataset.theme === "dark" : system.matches;
  }
  function label() {
    button.textContent = dark() ? "Light" : "Dark";
    button.setAttribute("aria-label", dark() ? "Switch to light colours" : "Switch to dark colours");
    document.dispatchEvent(new Event("recolour"));
  }
  if (stored() === "dark" || stored() === "light") root.dataset.theme = stored();
  button.hidden = false;
  button.addEventListener("click", function () {
    root.dataset.theme = dark() ? "light" : "dark";
    try { localStorage.setItem(KEY, root.dataset.theme); } catch (error) { /* files may have no storage */ }
    label();
  });
  system.addEventListener("change", label);
  label();
  window.addEventListener("beforeprint", function () {
    document.querySelectorAll("details").forEach(function (d) { d.open = true; });
  });
})();
