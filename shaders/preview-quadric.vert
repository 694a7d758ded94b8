// A point of a sphere or a cone: one grid of `rings` times `sectors` quadrangles is drawn for each of them, around its
// canonical surface, in two triangles each.
in vec4 row_x;  // from canonical to world space
in vec4 row_y;
in vec4 row_z;
in vec2 radii;
in float kind;
in float material;
uniform int rings;
uniform int sectors;

const float PI = 3.14159265;

void main() {
    int quadrangle = gl_VertexID / 6, corner = gl_VertexID % 6;
    int across = quadrangle % sectors + (corner == 1 || corner == 3 || corner == 4 ? 1 : 0);
    int along = quadrangle / sectors + (corner == 2 || corner == 4 || corner == 5 ? 1 : 0);
    float turn = 2.0 * PI * float(across % sectors) / float(sectors), up = float(along) / float(rings);
    vec3 around = vec3(cos(turn), sin(turn), 0.0), point, outwards;
    if (kind < 0.5) {
        point = outwards = vec3(around.xy * sin(PI * up), -cos(PI * up));
    } else {
        point = vec3(around.xy * mix(radii.x, radii.y, up), up);
        outwards = vec3(around.xy, radii.x - radii.y);
    }
    mat3 linear = transpose(mat3(row_x.xyz, row_y.xyz, row_z.xyz));
    vec3 moved = vec3(row_x.w, row_y.w, row_z.w) - eye;
    place(linear * point + moved, transpose(inverse(linear)) * outwards, vec2(0.0), material);
}
