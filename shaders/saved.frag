// Shadow rays of each pixel that were spared, by their range, or their share of those that were due.
uniform isampler2D saved_buffer;
uniform isampler2D due_rays_buffer;

void main() { finish_work(texelFetch(saved_buffer, pixel(), 0).r, texelFetch(due_rays_buffer, pixel(), 0).r); }
