// Shadow rays of each pixel that were spared, from none to `top` and more, or their share of those that were due.
uniform isampler2D saved_buffer;
uniform isampler2D due_rays_buffer;

void main() { finish_work(texelFetch(saved_buffer, pixel(), 0).r, texelFetch(due_rays_buffer, pixel(), 0).r); }
