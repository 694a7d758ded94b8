// What every view knows of a frame. Row 0 of the buffers is the top of the picture, and so is row 0 of the
// target: pixel (x, y) here is pixel (x, y) of the frame.

uniform sampler2D color_buffer;       // rgb, display-referred, unclamped
uniform isampler2D primitive_buffer;  // number of the primitive, -1 for a miss
uniform isampler2D unit_buffer;       // number of what carries modes, the primitive or a cell of it; -1 for a miss
uniform usampler2D mode_table;        // per unit: low and high half of its packed word of modes
uniform isampler2D count_table;       // per unit: pixels now, highest count
uniform int table_width;              // units per row of the two tables
uniform sampler2D color_map;          // from the lowest value to the highest
uniform vec3 background;
uniform float shading;                // how much of the picture's light and shade shows under flat colours, 0 to 1
uniform bool outlines;                // draw the borders between primitives
uniform int selected;                 // primitive drawn with a bright border, -1 for none
uniform isampler2D part_table;        // per primitive: the named part of the scene that it belongs to
uniform int selected_part;            // the part that has the border instead, -1 for none
uniform usampler2D mark_buffer;       // of verified frames: NONE, RING around wrong pixels, WRONG
uniform bool marked;                  // draw the rings
uniform vec3 wrong_color;
uniform bool shares;                  // heat maps: shares of a whole, not rays in `range`
uniform vec2 range;                   // what has the first and the last colour of the map
uniform vec3 unknown;                 // where there is nothing to show of what is seen
uniform int curve;                    // of tone: none, Reinhard's, filmic, sRGB
uniform float gain;                   // by which colours are exposed
uniform float white;                  // the exposed colour that becomes white
uniform bool clipping;                // stripe pixels that are too bright, or black
uniform vec3 clip_colors[2];          // of the two
const int RING = 1, WRONG = 2;

out vec4 result;

ivec2 pixel() { return ivec2(gl_FragCoord.xy); }

int primitive_at(ivec2 p) {
    return texelFetch(primitive_buffer, clamp(p, ivec2(0), textureSize(primitive_buffer, 0) - 1), 0).r;
}

int mark_at(ivec2 p) { return int(texelFetch(mark_buffer, p, 0).r); }

int unit_at(ivec2 p) { return texelFetch(unit_buffer, p, 0).r; }

ivec2 table_entry(int unit) { return ivec2(unit % table_width, unit / table_width); }

// Two bits of a packed word, at an even position from 0 to 62.
int two_bits(uvec2 word, int position) {
    uint half_word = position < 32 ? word.x : word.y;
    return int((half_word >> uint(position & 31)) & 3u);
}

int mode_bits(int unit, int position) {
    return two_bits(texelFetch(mode_table, table_entry(unit), 0).rg, position);
}

ivec2 counts_of(int unit) { return texelFetch(count_table, table_entry(unit), 0).rg; }

// Hable's filmic curve, before it is divided by that of white.
vec3 hable(vec3 x) {
    const float a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

vec3 srgb(vec3 x) {
    vec3 curved = 1.055 * pow(max(x, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return mix(curved, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

// A traced colour as the screen is to show it, not clipped yet.
vec3 toned(vec3 traced) {
    vec3 x = max(traced, 0.0) * gain;
    if (curve == 1) return x * (1.0 + x / (white * white)) / (1.0 + x);
    if (curve == 2) return hable(x) / hable(vec3(white));
    if (curve == 3) return srgb(x / white);
    return x / white;
}

vec3 displayed(vec3 traced) { return clamp(toned(traced), 0.0, 1.0); }

// The same, with stripes where the screen cuts something off and that is to be marked.
vec3 marked_where_clipped(vec3 traced) {
    vec3 shown = toned(traced);
    ivec2 p = pixel();
    if (clipping && ((p.x + p.y) / 4) % 2 == 0) {
        if (any(greaterThan(shown, vec3(1.0)))) return clip_colors[0];
        if (all(lessThanEqual(shown, vec3(0.0)))) return clip_colors[1];
    }
    return clamp(shown, 0.0, 1.0);
}

float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// A flat colour with some of the traced picture's light and shade, so that shapes stay readable.
vec3 shaded(vec3 flat_color) {
    vec3 traced = clamp(texelFetch(color_buffer, pixel(), 0).rgb, 0.0, 1.0);
    float light = 0.25 + 0.95 * sqrt(luminance(traced));
    return clamp(flat_color * mix(1.0, light, shading), 0.0, 1.0);
}

bool on_border(int primitive) {
    ivec2 p = pixel();
    return primitive_at(p + ivec2(1, 0)) != primitive || primitive_at(p + ivec2(0, 1)) != primitive;
}

bool is_selected(int primitive) {
    if (selected_part < 0 || primitive < 0) return primitive == selected;
    return texelFetch(part_table, table_entry(primitive), 0).r == selected_part;
}

bool on_selected_border() {
    if (selected < 0) return false;
    ivec2 p = pixel();
    int around = 0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            around += is_selected(primitive_at(p + ivec2(x, y))) ? 1 : 0;
    return around > 0 && around < 9;
}

// Every view ends here: what is selected on top, opaque.
void finish_over(vec3 color) { result = vec4(on_selected_border() ? vec3(1.0) : color, 1.0); }

// The same with the borders between primitives, where they are asked for.
void finish(vec3 color) { finish_over(outlines && on_border(primitive_at(pixel())) ? color * 0.35 : color); }

vec3 mapped(float t) { return texture(color_map, vec2(clamp(t, 0.0, 1.0), 0.5)).rgb; }

// A value from 0 to 1 on the colour map, and on the background where nothing is seen.
void finish_mapped(float t) {
    finish(primitive_at(pixel()) < 0 ? background : mapped(t));
}

// A number as its place on the colour map.
float in_range(float number) { return (number - range.x) / (range.y - range.x); }

// Rays at a pixel: how many, or which share of the whole; of none there is no share.
void finish_work(int rays, int whole) {
    if (shares && whole == 0 && primitive_at(pixel()) >= 0) finish(unknown);
    else finish_mapped(shares ? float(rays) / float(max(whole, 1)) : in_range(float(rays)));
}
