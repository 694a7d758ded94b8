// Light of a few lamps by Phong, as the tracer shades what nothing stands in the way of; no shadows, no reflections.
in vec3 seen;
in vec3 outward;
in vec2 mapped_at;
flat in int surface;
uniform vec3 eye;
uniform vec3 sky;                // ambient light
uniform sampler2D materials;     // three texels each: ambient, diffuse, specular
uniform int materials_a_row;
uniform sampler2D image;
uniform bool textured;
uniform vec4 lamps[16];          // place and extent; colour, and 1 where it falls off with distance
uniform int lamp_count;

out vec4 result;

vec4 material(int what) {
    return texelFetch(materials, ivec2(3 * (surface % materials_a_row) + what, surface / materials_a_row), 0);
}

void main() {
    vec4 ambient = material(0), diffuse = material(1), specular = material(2);
    // What lets light through hides a part of the pixels behind it: the sixteen thresholds of an ordered dither.
    ivec2 p = ivec2(gl_FragCoord.xy) & 3;
    int order = 8 * ((p.x ^ p.y) & 1) + 4 * (p.y & 1) + 2 * (((p.x ^ p.y) >> 1) & 1) + ((p.y >> 1) & 1);
    if ((float(order) + 0.5) / 16.0 < min(ambient.a, 0.75)) discard;

    vec3 geometric = normalize(cross(dFdx(seen), dFdy(seen)));
    if (dot(geometric, seen) > 0.0) geometric = -geometric;
    vec3 normal = dot(outward, outward) > 0.0 ? normalize(outward) : geometric;
    if (dot(normal, geometric) < 0.0) normal = -normal;
    vec3 color = textured ? texture(image, mapped_at).rgb : vec3(1.0);
    vec3 light = sky * ambient.rgb * color;
    // Mirrors, which have hardly a colour of their own, would be black.
    light += 0.35 * specular.rgb * max(1.0 - 3.0 * max(diffuse.r, max(diffuse.g, diffuse.b)), 0.0);
    vec3 way = normalize(seen);
    for (int i = 0; i < lamp_count; ++i) {
        vec4 place = lamps[2 * i], shine = lamps[2 * i + 1];
        vec3 to = place.xyz - eye - seen;
        if (dot(geometric, to) <= 0.0) continue;
        float away = length(to), cosine = dot(normal, to) / away;
        if (cosine <= 0.0) continue;
        float mirrored = max(dot(to, way) / away - 2.0 * cosine * dot(normal, way), 0.0);
        float gloss = mirrored > 0.0 ? pow(mirrored, specular.a) : 0.0;
        float arriving = shine.a > 0.5 ? 1.0 / (away * away + place.w * place.w) : 1.0;
        light += arriving * shine.rgb * (diffuse.rgb * color * cosine + specular.rgb * gloss);
    }
    result = vec4(clamp(light, 0.0, 1.0), 1.0);
}
