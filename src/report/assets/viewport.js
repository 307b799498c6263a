// The canvas with the pictures: pan, zoom, wipe. It knows nothing of tone maps and errors; it is given canvases to show.

class Viewport {
  constructor(canvas, width, height) {
    Object.assign(this, { canvas, width, height, zoom: 1, x: 0, y: 0, divider: 0.5, mode: 'wipe', panes: [], legend: null, fitted: true });
    this.onChange = () => {};
    this.onProbe = () => {};
    this.listen();
    new ResizeObserver(() => { if (this.fitted) this.fit(); else this.draw(); }).observe(canvas);
  }

  // Size in CSS pixels of the whole canvas and of the part that one picture gets.
  get size() { return { width: this.canvas.clientWidth, height: this.canvas.clientHeight }; }
  get paneWidth() { return this.mode === 'side' ? this.size.width / 2 : this.size.width; }

  fit() {
    const { height } = this.size, margin = 10;
    this.zoom = Math.max(0.01, Math.min((this.paneWidth - 2 * margin) / this.width, (height - 2 * margin) / this.height));
    this.x = (this.paneWidth - this.zoom * this.width) / 2;
    this.y = (height - this.zoom * this.height) / 2;
    this.fitted = true;
    this.draw();
  }

  zoomTo(zoom, centerX = this.paneWidth / 2, centerY = this.size.height / 2) {
    zoom = Math.min(64, Math.max(0.05, zoom));
    this.x = centerX - (centerX - this.x) * zoom / this.zoom;
    this.y = centerY - (centerY - this.y) * zoom / this.zoom;
    this.zoom = zoom;
    this.fitted = false;
    this.draw();
  }

  // panes: [{canvas, label}], one or two of them; the second lies right of the divider.
  show(mode, panes, legend) {
    const refit = this.fitted && mode !== this.mode;
    Object.assign(this, { mode, panes, legend });
    if (refit) this.fit(); else this.draw();
  }

  draw() {
    const ratio = window.devicePixelRatio || 1, { width, height } = this.size;
    if (!width || !height) return;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const context = this.canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.imageSmoothingEnabled = this.zoom * ratio < 2;
    context.imageSmoothingQuality = 'high';
    const split = this.mode === 'wipe' ? this.divider * width : width / 2;
    this.panes.forEach((pane, k) => {
      context.save();
      context.beginPath();
      if (this.panes.length === 1) context.rect(0, 0, width, height);
      else context.rect(k ? split : 0, 0, k ? width - split : split, height);
      context.clip();
      const shift = this.mode === 'side' && k ? split : 0;
      context.drawImage(pane.canvas, this.x + shift, this.y, this.zoom * this.width, this.zoom * this.height);
      context.restore();
    });
    if (this.panes.length === 2) {
      context.fillStyle = '#f4f4f4';
      context.fillRect(split - 0.75, 0, 1.5, height);
      if (this.mode === 'wipe') {
        context.beginPath();
        context.arc(split, height / 2, 9, 0, 2 * Math.PI);
        context.fill();
        context.fillStyle = '#1b1b1b';
        context.fillRect(split - 3.5, height / 2 - 4, 2, 8);
        context.fillRect(split + 1.5, height / 2 - 4, 2, 8);
      }
    }
    this.panes.forEach((pane, k) => this.drawLabel(context, pane.label, k === 1, k ? split : 0, this.panes.length === 2 && !k ? split : width));
    if (this.legend) this.drawLegend(context, width, height);
    this.onChange();
  }

  drawLabel(context, text, right, from, to) {
    context.font = '12px system-ui, sans-serif';
    const width = context.measureText(text).width + 14;
    if (to - from < width + 16) return;
    const x = right ? to - width - 8 : from + 8;
    context.fillStyle = 'rgba(20, 20, 20, 0.78)';
    context.fillRect(x, 8, width, 22);
    context.fillStyle = '#e8e8e8';
    context.fillText(text, x + 7, 23);
  }

  drawLegend(context, width, height) {
    const { table, low, high, label } = this.legend, bar = Math.min(260, width / 2), x = width - bar - 24, y = height - 30;
    context.fillStyle = 'rgba(20, 20, 20, 0.78)';
    context.fillRect(x - 14, y - 24, bar + 28, 46);
    for (let i = 0; i < bar; ++i) {
      const entry = 3 * Math.round(i / bar * 1023);
      context.fillStyle = `rgb(${table[entry]}, ${table[entry + 1]}, ${table[entry + 2]})`;
      context.fillRect(x + i, y, 1.5, 9);
    }
    context.fillStyle = '#e8e8e8';
    context.font = '11px system-ui, sans-serif';
    context.fillText(label, x, y - 9);
    context.fillText(low, x, y + 19);
    context.textAlign = 'right';
    context.fillText(high, x + bar, y + 19);
    context.textAlign = 'left';
  }

  // Picture pixel under a point of the canvas, or null.
  pixelAt(x, y) {
    if (this.mode === 'side' && x > this.size.width / 2) x -= this.size.width / 2;
    const px = Math.floor((x - this.x) / this.zoom), py = Math.floor((y - this.y) / this.zoom);
    return px >= 0 && py >= 0 && px < this.width && py < this.height ? { x: px, y: py } : null;
  }

  listen() {
    let drag = null;
    const nearDivider = event => this.mode === 'wipe' && this.panes.length === 2 && Math.abs(event.offsetX - this.divider * this.size.width) < 10;
    this.canvas.addEventListener('pointerdown', event => {
      drag = nearDivider(event) ? { divider: true } : { x: event.offsetX - this.x, y: event.offsetY - this.y };
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointermove', event => {
      this.canvas.classList.toggle('on-divider', !!drag?.divider || (!drag && nearDivider(event)));
      this.onProbe(this.pixelAt(event.offsetX, event.offsetY));
      if (!drag) return;
      if (drag.divider) {
        this.divider = Math.min(1, Math.max(0, event.offsetX / this.size.width));
      } else {
        this.x = event.offsetX - drag.x;
        this.y = event.offsetY - drag.y;
        this.fitted = false;
      }
      this.draw();
    });
    const stop = () => { drag = null; };
    this.canvas.addEventListener('pointerup', stop);
    this.canvas.addEventListener('pointercancel', stop);
    this.canvas.addEventListener('pointerleave', () => this.onProbe(null));
    this.canvas.addEventListener('wheel', event => {
      event.preventDefault();
      const x = this.mode === 'side' && event.offsetX > this.size.width / 2 ? event.offsetX - this.size.width / 2 : event.offsetX;
      this.zoomTo(this.zoom * 2 ** (-event.deltaY / 300), x, event.offsetY);
    }, { passive: false });
  }
}
