/* Of the HAL what the example calls. */
#include <stdint.h>
typedef struct { uint32_t counter, compare; } TIM_HandleTypeDef;
#define TIM_CHANNEL_1 0u
#define TIM_CHANNEL_2 4u
#define GPIOB 1
#define GPIO_PIN_0 1u
#define GPIO_PIN_1 2u
typedef enum { GPIO_PIN_RESET, GPIO_PIN_SET } GPIO_PinState;
void HAL_GPIO_WritePin(int port, uint16_t pin, GPIO_PinState state);
#define __HAL_TIM_GET_COUNTER(timer) ((timer)->counter)
#define __HAL_TIM_SET_COMPARE(timer, channel, value) ((timer)->compare = (value) + (channel))
void Error_Handler(void);
void flight_begin(void);
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer);
