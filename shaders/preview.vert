// A corner of a triangle, in world space; row 0 of the target is the top of the picture.
in vec3 position;
in vec3 normal;
in vec3 color;
uniform vec3 eye;
uniform mat3 view;       // rows: right, up and forward
uniform vec2 slope;      // half the picture's width and height at distance 1
uniform vec2 near_far;   // the nearest and the farthest that is drawn

out vec3 seen;           // from the eye
out vec3 outward;
out vec3 tint;

void main() {
    vec3 p = (position - eye) * view;
    float n = near_far.x, f = near_far.y;
    gl_Position = vec4(p.x / slope.x, -p.y / slope.y, (p.z * (f + n) - 2.0 * f * n) / (f - n), p.z);
    seen = position - eye;
    outward = normal;
    tint = color;
}
