// How many pixels a unit covers now, against the most it covered while fully rendered: at zoom_factor times
// that, its modes are no longer trusted. Logarithmic, from 1 / zoom_factor to zoom_factor; grey has no highest count.
uniform float zoom_factor;

void main() {
    int unit = unit_at(pixel());
    if (unit < 0) { finish(background); return; }
    ivec2 counts = counts_of(unit);
    if (counts.y <= 0) { finish(shaded(unknown)); return; }
    float ratio = float(max(counts.x, 1)) / float(counts.y);
    float t = 0.5 + 0.5 * log(ratio) / log(max(zoom_factor, 1.01));
    finish(shaded(mapped(t)));
}
