// Where a vertex of the preview comes to lie: row 0 of the target is the top of the picture.
uniform vec3 eye;
uniform mat3 view;       // rows: right, up and forward
uniform vec2 slope;      // half the picture's width and height at distance 1
uniform vec2 near_far;   // the nearest and the farthest that is drawn

out vec3 seen;           // from the eye
out vec3 outward;
out vec2 mapped_at;
flat out int surface;

void place(vec3 at, vec3 normal, vec2 uv, float material) {
    vec3 p = at * view;
    float n = near_far.x, f = near_far.y;
    gl_Position = vec4(p.x / slope.x, -p.y / slope.y, (p.z * (f + n) - 2.0 * f * n) / (f - n), p.z);
    seen = at;
    outward = normal;
    mapped_at = uv;
    surface = int(material + 0.5);
}
