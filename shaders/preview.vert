// A corner of a triangle, in world space.
in vec3 position;
in vec3 normal;
in vec2 uv;
in float material;

void main() { place(position - eye, normal, uv, material); }
