// Plays an animation in a canvas. `root` has the canvas, a button and a slider; player.rs describes `data`.
(function (root, data) {
  const canvas = root.querySelector("canvas"), button = root.querySelector("button"), slider = root.querySelector("input");
  const scale = window.devicePixelRatio || 1, width = 640, height = data.height, margin = { left: 56, right: 12, top: 26, bottom: 36 };
  canvas.width = width * scale;
  canvas.height = height * scale;
  canvas.style.width = width + "px";
  const pen = canvas.getContext("2d");
  const [left, right, low, high] = data.box, inner = [width - margin.left - margin.right, height - margin.top - margin.bottom];
  const unit = [inner[0] / (right - left), inner[1] / (high - low)];
  if (data.equal) unit.fill(Math.min(unit[0], unit[1]));
  const middle = [margin.left + inner[0] / 2, margin.top + inner[1] / 2];
  const place = (x, y) => [middle[0] + (x - (left + right) / 2) * unit[0], middle[1] - (y - (low + high) / 2) * unit[1]];
  const colours = ["#1f77b4", "#ff7f0e", "#2ca02c", "#9467bd", "#8c564b", "#e377c2", "#17becf", "#bcbd22"];

  function line(points) {
    pen.beginPath();
    let down = false;
    for (const [x, y] of points) {
      if (x === null || y === null) { down = false; continue; }
      const [u, v] = place(x, y);
      if (down) pen.lineTo(u, v); else pen.moveTo(u, v);
      down = true;
    }
    pen.stroke();
  }

  function dot(x, y, size, colour) {
    if (x === null || y === null) return;
    pen.fillStyle = colour;
    pen.beginPath();
    pen.arc(...place(x, y), size, 0, 2 * Math.PI);
    pen.fill();
  }

  function frameAndLabels(t) {
    pen.fillStyle = "#333";
    pen.strokeStyle = "#999";
    pen.lineWidth = 1;
    pen.strokeRect(margin.left, margin.top, inner[0], inner[1]);
    pen.font = "12px sans-serif";
    pen.textAlign = "left";
    pen.fillText(data.title + "   t = " + t.toPrecision(5), margin.left, 16);
    pen.textAlign = "center";
    pen.fillText(data.labels[0], middle[0], height - 6);
    for (const x of data.ticks[0]) pen.fillText(String(x), place(x, 0)[0], margin.top + inner[1] + 15);
    pen.textAlign = "right";
    for (const y of data.ticks[1]) pen.fillText(String(y), margin.left - 5, place(0, y)[1] + 4);
    pen.save();
    pen.translate(12, middle[1]);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(data.labels[1], 0, 0);
    pen.restore();
  }

  function draw(frame) {
    const t = data.times[frame];
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    frameAndLabels(t);
    pen.save();
    pen.beginPath();
    pen.rect(margin.left, margin.top, inner[0], inner[1]);
    pen.clip();
    pen.strokeStyle = "#666";
    for (const segment of data.borders[Math.min(frame, data.borders.length - 1)] || []) line(segment);
    data.curves.forEach((curve, index) => {
      const colour = colours[index % colours.length];
      pen.strokeStyle = colour;
      const count = curve.times.findIndex((time) => time > t);
      line(curve.path.slice(0, count < 0 ? curve.path.length : count).concat([curve.heads[frame]]));
      for (const [time, x, y] of curve.impacts) if (time <= t) dot(x, y, 2.5, "#d62728");
      dot(...curve.heads[frame], 5, colour);
    });
    pen.restore();
    slider.value = frame;
  }

  let playing = false, begun = 0, from = 0;
  function tick(now) {
    if (!playing || !root.isConnected) return;
    const frame = from + Math.floor((now - begun) * data.fps / 1000);
    draw(Math.min(frame, data.times.length - 1));
    if (frame >= data.times.length - 1) set(false); else requestAnimationFrame(tick);
  }
  function set(plays) {
    playing = plays;
    button.textContent = plays ? "❚❚" : "▶";
    if (!plays) return;
    from = Number(slider.value) >= data.times.length - 1 ? 0 : Number(slider.value);
    begun = performance.now();
    requestAnimationFrame(tick);
  }
  set(false);
  slider.max = data.times.length - 1;
  slider.addEventListener("input", () => { set(false); draw(Number(slider.value)); });
  button.addEventListener("click", () => set(!playing));
  draw(data.times.length - 1);
})
