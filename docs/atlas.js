// The atlas: choose a place on a map and see both films of it. No server, no library: data and frames are next to it.
(() => {
  const atlas = JSON.parse(document.getElementById("atlas-data").textContent);
  const find = (selector) => [...document.querySelectorAll(`#atlas ${selector}`)];
  const [slider, button, said] = ["step", "play", "said"].map((name) => document.getElementById(`atlas-${name}`));
  const STEPS_A_SECOND = 40; // half of the robot's
  const ends = (film) => (film.succeeds ? "succeeds" : "fails");
  let chosen, sheets = {}, playing = false, step = 0, before = 0;

  function draw() {
    slider.value = step;
    for (const canvas of find("canvas")) {
      const method = canvas.dataset.method, film = chosen.films[method];
      const frame = Math.min(Math.floor(step / atlas.stride), film.frames - 1), size = atlas.size;
      const left = size * (frame % atlas.columns), top = size * Math.floor(frame / atlas.columns);
      if (sheets[method].complete && sheets[method].naturalWidth) {
        canvas.getContext("2d").drawImage(sheets[method], left, top, size, size, 0, 0, size, size);
      }
      const over = step >= film.steps;
      find(`figcaption[data-method=${method}]`)[0].textContent =
        `${atlas.names[method]}, step ${Math.min(Math.floor(step), film.steps)}${over ? `: ${ends(film)}` : ""}`;
    }
    button.textContent = playing ? "Pause" : "Play";
  }

  function tick(now) {
    if (!playing) return;
    step = Math.min(step + ((now - before) / 1000) * STEPS_A_SECOND, slider.max);
    before = now;
    if (step >= slider.max) playing = false;
    draw();
    requestAnimationFrame(tick);
  }

  function play(on) {
    if (on && step >= slider.max) step = 0;
    playing = on;
    draw();
    requestAnimationFrame((now) => { before = now; tick(now); });
  }

  function choose(number, start) {
    chosen = atlas.places[number];
    step = 0;
    slider.max = Math.max(...Object.values(chosen.films).map((film) => film.steps));
    for (const one of find("button[data-place]")) {
      const same = one.dataset.place === String(number);
      one.setAttribute("aria-pressed", same);
      one.tabIndex = same ? 0 : -1;
    }
    for (const [method, film] of Object.entries(chosen.films)) {
      sheets[method] = new Image();
      sheets[method].onload = draw;
      sheets[method].src = `_static/atlas/${film.file}`;
    }
    said.textContent = `The object is at x ${chosen.x} cm, y ${chosen.y} cm. ` + Object.entries(chosen.films)
      .map(([method, film]) => `${atlas.names[method]} ${ends(film)}`).join(", ") + ".";
    play(start && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  for (const map of find(".places")) {
    const places = [...map.children];
    map.addEventListener("click", (event) => {
      const place = event.target.closest("button");
      if (place) choose(place.dataset.place, true);
    });
    map.addEventListener("keydown", (event) => {
      const [right, down] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key]
        || [0, 0];
      if (!right && !down) return;
      event.preventDefault();
      event.stopPropagation(); // the theme turns pages with arrow keys
      const at = places.indexOf(document.activeElement), side = atlas.side;
      const column = (at % side) + right, row = Math.floor(at / side) + down;
      if (column < 0 || column >= side || row < 0 || row >= side) return;
      places[row * side + column].focus();
      choose(places[row * side + column].dataset.place, true);
    });
  }
  slider.addEventListener("input", () => { playing = false; step = Number(slider.value); draw(); });
  slider.addEventListener("keydown", (event) => event.stopPropagation());
  button.addEventListener("click", () => play(!playing));
  const all = Object.keys(atlas.places);
  choose(all[Math.floor(all.length / 2)], false);
})();
