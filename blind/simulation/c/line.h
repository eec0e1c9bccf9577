/* Commands on their way to a rig, one line an input. */
typedef struct {
    double sent_s[256], luck[256], u_V[256];          /* commands under way, oldest first at `tail` */
    int head, tail;
    double now_V;
} line_t;

void line_send(line_t *line, double t_s, double luck, double u_V);
double line_arrived(line_t *line, double t_s, double delay_s, double spread);
