// Left of a column of pixels the traced picture, right of it the one in which every shadow answer is right.
uniform sampler2D reference_buffer;  // like color_buffer
uniform int column;
uniform bool line;                   // draw that column
uniform vec3 line_color;

void main() {
    ivec2 p = pixel();
    if (line && p.x == column) { finish_over(line_color); return; }
    vec3 traced = texelFetch(color_buffer, p, 0).rgb, right = texelFetch(reference_buffer, p, 0).rgb;
    vec3 color = marked_where_clipped(p.x < column ? traced : right);
    if (marked && mark_at(p) == RING) finish_over(wrong_color);  // the pixels inside it stay as they are
    else finish(color);
}
