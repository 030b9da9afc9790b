/* alone.c - the header compiles by itself and when included twice, as C99 and as C++11. */
#include "posewise.h"
#include "posewise.h"

posewise_status use_everything(posewise_tracker *t, const posewise_frame *f, posewise_result *r);
posewise_status use_everything(posewise_tracker *t, const posewise_frame *f, posewise_result *r) {
    static const posewise_config config = POSEWISE_CONFIG_INIT;
    static const posewise_frame frame = POSEWISE_FRAME_INIT;
    static const posewise_result result = POSEWISE_RESULT_INIT;
    *r = result;
    return posewise_step(t, config.flags == 0 ? f : &frame, r);
}
