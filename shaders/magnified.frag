// A part of a picture, as large as the target: each of its pixels as a rectangle of one colour.
uniform sampler2D source;
uniform vec4 part;  // of the picture: left, top, width and height, 0 to 1
uniform vec2 size;  // of the target
out vec4 result;

void main() {
    ivec2 whole = textureSize(source, 0);
    ivec2 p = ivec2(floor((part.xy + gl_FragCoord.xy / size * part.zw) * vec2(whole)));
    result = texelFetch(source, clamp(p, ivec2(0), whole - 1), 0);
}
